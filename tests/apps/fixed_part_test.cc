// A textured thing that is fixed to the camera: found, told and left out, or named by a mask.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/io/files/image_file.h"
#include "support/read_text.h"
#include "support/rendered.h"
#include "support/texture.h"

namespace alidade::fixed_part_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr int kFrames = 110;
const cv::Rect kGripper(110, 150, 100, 90);  // of 320 × 240: 12 %

class FixedPart : public testing::Test {
 protected:
  static std::string RoomWithout() {
    return Rendered({"room", "--frames", std::to_string(kFrames), "--seed", "4", "--width", "320",
                     "--height", "240"});
  }
  // A room, 320 × 240, with a thing 0.3 m from the camera in every frame.
  std::string With(const cv::Rect& part) {
    const std::string room = CopyOf(RoomWithout(), folder_);
    const cv::Mat thing = MakeTexture(part.width, part.height, 3);
    for (const auto& entry : fs::directory_iterator(room + "/rgb")) {
      cv::Mat image = ReadImageColor(entry.path().string());
      cv::Mat color;
      cv::cvtColor(thing, color, cv::COLOR_GRAY2BGR);
      color.copyTo(image(part));
      WriteImage(entry.path().string(), image);
    }
    for (const auto& entry : fs::directory_iterator(room + "/depth")) {
      cv::Mat depth = ReadDepth(entry.path().string());
      depth(part).setTo(0.3 * 5000);
      WriteImage(entry.path().string(), depth);
    }
    return room;
  }
  ProgramResult Run(const std::string& source, std::vector<std::string> options) {
    std::vector<std::string> arguments = {"run", source, "--out", out_, "--overwrite"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return RunAlidade(arguments);
  }
  // Of the same room without the gripper.
  double Undisturbed(const std::string& sensor) {
    const std::string room = RoomWithout();
    EXPECT_EQ(Run(room, {"--sensor", sensor}).status, 0);
    return Ate(room).value("rmse", 0.0);
  }
  json Ate(const std::string& truth) const {
    const ProgramResult result =
        RunAlidade({"evaluate", "ate", truth, out_ + "/trajectory.txt", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false);
  }
  double LeftOut() const {
    return json::parse(ReadText(out_ + "/stats.json")).at("left_out").get<double>();
  }

  TempFolder folder_;
  std::string out_ = folder_ / "out";
};

TEST_F(FixedPart, IsFoundToldAndLeftOutOfAllPoses) {
  const std::string room = With(kGripper);
  for (const char* sensor : {"rgbd", "mono"}) {
    const double undisturbed = Undisturbed(sensor);
    const ProgramResult result = Run(room, {"--sensor", sensor});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("of the image moves with the camera")) << sensor;
    EXPECT_NEAR(LeftOut(), 0.12, 0.04) << sensor;
    const json ate = Ate(room);
    EXPECT_LT(ate.value("rmse", 1e9), 2 * undisturbed) << sensor;
    EXPECT_GE(ate.value("n", 0), kFrames - 25) << sensor;
  }
}

TEST_F(FixedPart, AHoodOverAQuarterOfTheImageIsFound) {
  const std::string room = With({0, 180, 320, 60});
  const ProgramResult result = Run(room, {"--sensor", "rgbd"});
  EXPECT_THAT(result.err, HasSubstr("of the image moves with the camera"));
  EXPECT_NEAR(LeftOut(), 0.25, 0.04);
  EXPECT_LT(Ate(room).value("rmse", 1e9), 0.02);
}

TEST_F(FixedPart, IsNotLookedForWhenTheSettingIsOff) {
  const std::string room = With(kGripper);
  const ProgramResult result =
      Run(room, {"--sensor", "rgbd", "--set", "expert.fixed_parts=false", "--dynamics", "off"});
  EXPECT_THAT(result.err, Not(HasSubstr("moves with the camera")));
  EXPECT_GT(Ate(room).value("rmse", 0.0), 0.1) << "the case this is about";
}

TEST_F(FixedPart, AMaskNamesItFromTheFirstFrameOn) {
  const std::string room = With(kGripper);
  cv::Mat mask(480, 640, CV_8U, cv::Scalar(0));  // of the shape, not of the size, of the images
  mask(cv::Rect(2 * kGripper.x - 6, 2 * kGripper.y - 6, 2 * kGripper.width + 12,
                2 * kGripper.height + 6))
      .setTo(255);
  WriteImage(folder_ / "mask.png", mask);
  const double undisturbed = Undisturbed("rgbd");
  const ProgramResult result = Run(room, {"--sensor", "rgbd", "--mask", folder_ / "mask.png"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("moves with the camera")));
  EXPECT_NEAR(LeftOut(), 0.13, 0.02);
  EXPECT_LT(Ate(room).value("rmse", 1e9), 2 * undisturbed);
}

TEST_F(FixedPart, AMaskThatCannotBeMeantIsRefused) {
  const std::string room =
      Rendered({"room", "--frames", "5", "--seed", "4", "--width", "320", "--height", "240"});
  const auto refuse = [&](const cv::Mat& mask) {
    WriteImage(folder_ / "mask.png", mask);
    const ProgramResult result = Run(room, {"--mask", folder_ / "mask.png"});
    EXPECT_EQ(result.status, 3);
    return result.err;
  };
  EXPECT_THAT(refuse(cv::Mat(100, 640, CV_8U, cv::Scalar(0))), HasSubstr("does not fit"));
  EXPECT_THAT(refuse(cv::Mat(240, 320, CV_8U, cv::Scalar(0))), HasSubstr("leaves out nothing"));
  EXPECT_THAT(refuse(cv::Mat(240, 320, CV_8U, cv::Scalar(255))), HasSubstr("100 %"));
  EXPECT_EQ(Run(room, {"--mask", folder_ / "none.png"}).status, 3);
}

}  // namespace
}  // namespace alidade::fixed_part_test
