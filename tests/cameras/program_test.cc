// The program with a camera: `alidade cameras`, `alidade run camera:0`.
#include "support/program.h"

#include <gtest/gtest.h>

#include "alidade/evaluation/ate.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/sources/any_source.h"

namespace alidade::cameras_program_test {
namespace {

constexpr double kFps = 30;

class CameraProgram : public testing::Test {
 protected:
  CameraProgram() {
    setenv("LD_PRELOAD", ALIDADE_FAKE_V4L2, 1);
    setenv("FAKE_V4L2_FOLDER", folder_.path().c_str(), 1);
  }

  void Render(int frames) {
    const auto room =
        OpenAnySource("synth:room?width=320&height=240&path=walk&frames=" + std::to_string(frames));
    camera_ = room->Info().camera;
    while (auto frame = room->Next()) {
      char name[20];
      std::snprintf(name, sizeof name, "/%04d.jpg", frame->number);
      std::ofstream(folder_.path() + name, std::ios::binary) << EncodeJpeg(frame->image, 95);
      truth_.push_back({frame->number / kFps, *frame->T_world_camera, {}});
    }
  }
  ~CameraProgram() override {
    for (const char* name : {"LD_PRELOAD", "FAKE_V4L2_FOLDER", "FAKE_V4L2_GONE_AFTER"})
      unsetenv(name);
  }

  // Runs for `seconds`, then Ctrl-C.
  ProgramResult Run(const std::vector<std::string>& arguments, double seconds) {
    return RunAlidade(arguments, [&](pid_t child) {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
      kill(child, SIGINT);
    });
  }

  const TempFolder folder_;
  Camera camera_;
  Trajectory truth_;
};

TEST_F(CameraProgram, ListsWhatIsThere) {
  Render(2);
  const ProgramResult listed = RunAlidade({"cameras"});
  EXPECT_EQ(listed.status, 0) << listed.err;
  EXPECT_NE(listed.out.find("camera:0  Rendered Camera (/dev/video0)"), std::string::npos);
  EXPECT_NE(listed.out.find("* MJPEG   320 x 240   fps=30*, 15"), std::string::npos) << listed.out;
  EXPECT_NE(listed.out.find("focus 0 to 250, automatic"), std::string::npos);
  const ProgramResult json = RunAlidade({"cameras", "--json"});
  EXPECT_NE(json.out.find("\"device\": \"/dev/video0\""), std::string::npos) << json.out;
  unsetenv("LD_PRELOAD");
  EXPECT_EQ(RunAlidade({"cameras"}).status, 0);  // as this machine is
}

// Unplugged after five seconds, and plugged in again under another number.
TEST_F(CameraProgram, FollowsARenderedWalkAndSurvivesThatItIsUnplugged) {
  Render(120);
  setenv("FAKE_V4L2_GONE_AFTER", "130", 1);
  const TempFolder out;
  const double fov = 2 * std::atan(camera_.width / (2 * camera_.fx)) * 180 / CV_PI;
  const ProgramResult result =
      Run({"run", "camera:0?fps=30", "--fov", std::to_string(fov), "--out", out / "run"}, 9);
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_NE(result.err.find("camera0 is gone"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("camera0 is back: Rendered Camera"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("focus held"), std::string::npos) << result.out;
  // Until it was unplugged. Times count from the program's first image, which is one of the first.
  Trajectory there;
  for (const StampedPose& pose : ReadTrajectory(out / "run/trajectory.txt")) {
    if (pose.time < 3.5) there.push_back(pose);
  }
  ASSERT_GT(there.size(), 50u);
  double best = std::numeric_limits<double>::infinity();
  for (int first = 0; first < 15; ++first) {
    Trajectory shifted = there;
    for (StampedPose& pose : shifted) pose.time += first / kFps;
    AteSettings settings;
    settings.align = Alignment::kSim3;
    best = std::min(best, EvaluateAte(truth_, shifted, settings).error.rmse);
  }
  EXPECT_LT(best, 0.05);  // meters
}

}  // namespace
}  // namespace alidade::cameras_program_test
