// The program alidade-gl: a recorded run drawn in a window on a virtual screen (Xvfb).
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "alidade/base/random.h"
#include "alidade/gles/orbit.h"
#include "gles/expected.h"
#include "gles/told_scene.h"
#include "support/temp_folder.h"

namespace alidade::gles_test::window_test {
namespace {

class Window : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_ / name; }

  // The file format of docs/reference/stream.md.
  void Write(const Teller& teller) const {
    std::ofstream file(Path("run.stream"), std::ios::binary);
    file << "ALIDSTR1";
    for (const std::string& message : teller.messages) {
      const auto size = static_cast<uint32_t>(message.size());
      char header[8] = {};
      std::memcpy(header, &size, sizeof size);
      file.write(header, sizeof header);
      file << message << std::string((8 - size % 8) % 8, '\0');
    }
  }

  struct Outcome {
    int status = -1;
    std::string text;
  };
  Outcome Run(const std::string& arguments, bool screen) const {
    std::string command = std::string(ALIDADE_GL_BINARY) + " " + arguments;
    if (screen) {
      command =
          "Xvfb -displayfd 3 -screen 0 800x600x24 3>" + Path("display") +
          " & screen=$!; tries=0; while [ ! -s " + Path("display") +
          " ] && [ $tries -lt 300 ]; do sleep 0.1; tries=$((tries+1)); done; DISPLAY=:$(cat " +
          Path("display") + ") " + command +
          "; status=$?; kill $screen; wait $screen; exit $status";
    } else {
      command = "unset DISPLAY WAYLAND_DISPLAY; " + command;
    }
    const int status = std::system(("(" + command + ") >" + Path("said") + " 2>&1").c_str());
    std::ostringstream text;
    text << std::ifstream(Path("said")).rdbuf();
    return {WEXITSTATUS(status), text.str()};
  }

 private:
  const TempFolder folder_;
};

TEST_F(Window, ShowsTheEndOfARunWhereItsMapIs) {
  if (std::system("command -v Xvfb >/dev/null") != 0) GTEST_SKIP() << "no Xvfb (Debian: xvfb)";
  Random random(3);
  Teller teller(Camera::FromFieldOfView(640, 480, 70));
  Change change;
  for (uint32_t k = 0; k < 4; ++k) change.keyframes.push_back({k, 0, {{}, {0.3 * k, 0, 0}}, 1});
  for (auto& keyframe : change.keyframes) keyframe.T_world_camera.R.setIdentity();
  for (uint32_t i = 0; i < 200; ++i) {
    const double x = random.Uniform(-2, 2);
    const double y = random.Uniform(-1, 1);
    const double z = random.Uniform(1, 4);
    change.landmarks.push_back({i, i % 4, Eigen::Vector3d(x, y, z).cast<float>()});
  }
  teller.Tell(change);
  for (uint32_t k = 0; k < 4; ++k) teller.TellFrame(k, {});
  Write(teller);
  const Outcome outcome =
      Run(Path(".") + " --width 500 --height 400 --screenshot " + Path("shot.png"), true);
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  const cv::Mat image = cv::imread(Path("shot.png"));
  ASSERT_EQ(image.size(), cv::Size(500, 400)) << outcome.text;
  gles::ViewSettings view;
  gles::Orbit orbit;
  orbit.Fit(teller.scene);
  orbit.Apply(view);
  const Lens lens(view, 500, 400);
  int seen = 0, dark = 0;
  for (const auto& [id, landmark] : teller.scene.landmarks) {
    const auto at = lens.See(teller.scene.PointOf(landmark));
    if (!at) continue;
    ++seen;
    const cv::Vec3b bgr = image.at<cv::Vec3b>(static_cast<int>(at->y()), static_cast<int>(at->x()));
    dark += Difference({bgr[2], bgr[1], bgr[0], 255}, PixelOf(view.colors.background)) < 20;
  }
  EXPECT_GT(seen, 150);
  EXPECT_EQ(dark, 0);
}

TEST_F(Window, SaysWhyThereIsNone) {
  Outcome outcome = Run(Path("nothing.stream"), false);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.text.find("nothing.stream"), std::string::npos) << outcome.text;
  outcome = Run(Path("."), false);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.text.find("--record"), std::string::npos) << outcome.text;
  EXPECT_EQ(Run("--speed fast " + Path("."), false).status, 2);
  Write(Teller(Camera::FromFieldOfView(640, 480, 70)));
  outcome = Run(Path("."), false);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.text.find("cannot open a window"), std::string::npos) << outcome.text;
  outcome = Run("--help", false);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.text.find("Examples"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace alidade::gles_test::window_test
