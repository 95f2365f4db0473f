// The commands of the tutorials, as they stand in the pages, on rendered recordings.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "alidade/evaluation/ate.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/trajectory_file.h"
#include "bags/bag_bytes.h"
#include "bags/message_bytes.h"
#include "support/rendered.h"

namespace alidade::tutorials_test {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

// The lines of a page's shell blocks that begin with `alidade`, without comments.
std::vector<std::string> CommandsIn(const std::string& page) {
  std::vector<std::string> commands;
  bool shell = false;
  for (const std::string& line : ReadLines(std::string(ALIDADE_DOCS) + "/" + page)) {
    if (line.rfind("```", 0) == 0) {
      shell = line == "```sh";
    } else if (shell && line.rfind("alidade ", 0) == 0) {
      commands.push_back(line.substr(0, line.find("  #")));
    }
  }
  return commands;
}

class Tutorials : public testing::Test {
 protected:
  // Runs a command with the program first in PATH, in the test's folder.
  ProgramResult Shell(const std::string& command) const {
    const std::string path = fs::path(ALIDADE_BINARY).parent_path().string();
    return RunProgram("/bin/bash", {"-c", "PATH=" + path + ":$PATH; " + command}, nullptr,
                      folder_.path());
  }
  void RunAll(const std::string& page) {
    for (const std::string& command : CommandsIn(page)) {
      if (command.rfind("alidade view", 0) == 0) continue;  // serves until it is stopped
      const ProgramResult result = Shell(command);
      EXPECT_EQ(result.status, 0) << command << "\n" << result.err;
    }
  }
  bool Has(const std::string& name) const { return fs::exists(folder_ / name); }
  TempFolder folder_;
};

TEST_F(Tutorials, FromAVideoToATrainingFolder) {
  const std::string room =
      Rendered({"room", "--frames", "110", "--seed", "4", "--width", "320", "--height", "240"});
  const auto images = DataLines(room + "/rgb.txt");
  cv::VideoWriter writer;
  for (const std::string& line : images) {
    const cv::Mat image = ReadImageColor(room + "/" + line.substr(line.find(' ') + 1));
    if (!writer.isOpened()) {
      ASSERT_TRUE(writer.open(folder_ / "walk.mp4", cv::CAP_FFMPEG,
                              cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30, image.size()));
    }
    writer.write(image);
  }
  writer.release();
  EXPECT_THAT(CommandsIn("tutorial.md"), Contains(StartsWith("alidade run walk.mp4")));
  RunAll("tutorial.md");
  for (const char* name :
       {"alidade-out/walk/report.html", "alidade-out/walk/semidense.ply",
        "alidade-out/walk/run.stream", "walk-gs/sparse/0/points3D.bin", "walk-ns/transforms.json"})
    EXPECT_TRUE(Has(name)) << name;
  for (const char* folder : {"walk-gs", "walk-ns"}) {
    const auto first = fs::directory_iterator(folder_ / folder + "/images")->path();
    const cv::Size size = ReadImageSize(first.string());
    EXPECT_EQ(ReadImageSize(folder_ / folder + "/preview.jpg"),
              cv::Size(2 * size.width, size.height));
  }
}

std::string StampOf(const std::string& line) { return line.substr(0, line.find(' ')); }

int64_t Nanoseconds(const std::string& stamp) {
  const size_t point = stamp.find('.');
  std::string digits = stamp.substr(point + 1);
  digits.resize(9, '0');
  return std::stoll(stamp.substr(0, point)) * 1'000'000'000 + std::stoll(digits);
}

// A RealSense's topics as ROS 1 messages, of the frames from `first` to `last`.
std::string DepthCameraBag(const std::string& recording, size_t first, size_t last) {
  std::map<std::string, double> values;
  for (const std::string& line : DataLines(recording + "/camera.yaml")) {
    const size_t colon = line.find(": ");
    if (colon != std::string::npos) values[line.substr(0, colon)] = std::atof(&line[colon + 2]);
  }
  const double fx = values.at("fx"), fy = values.at("fy"), cx = values.at("cx"),
               cy = values.at("cy");
  InfoFields info;
  info.width = static_cast<uint32_t>(values.at("width"));
  info.height = static_cast<uint32_t>(values.at("height"));
  info.K = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  info.P = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
  const double millimeters = 1000 / values.at("depth_factor");
  const auto images = DataLines(recording + "/rgb.txt"),
             depths = DataLines(recording + "/depth.txt");
  const auto file = [&](const std::string& line) {
    return recording + "/" + line.substr(line.find(' ') + 1);
  };
  std::vector<WrittenMessage> messages;
  for (size_t i = first; i < last; ++i) {
    const int64_t stamp = Nanoseconds(StampOf(images[i]));
    cv::Mat depth;
    ReadDepth(file(depths[i])).convertTo(depth, CV_16U, millimeters);
    messages.push_back({"/camera/color/image_raw", "sensor_msgs/Image", stamp,
                        ImageMessage({false}, stamp, "camera_color_optical_frame", "bgr8",
                                     ReadImageColor(file(images[i])))});
    messages.push_back({"/camera/color/camera_info", "sensor_msgs/CameraInfo", stamp,
                        InfoMessage({false}, stamp, info)});
    messages.push_back(
        {"/camera/aligned_depth_to_color/image_raw", "sensor_msgs/Image", stamp,
         ImageMessage({false}, stamp, "camera_color_optical_frame", "16UC1", depth)});
  }
  return BagBytes({"lz4"}).Of(messages);
}

TEST_F(Tutorials, FromADepthCamerasBagToAMapAndBack) {
  const std::string room =
      Rendered({"room", "--frames", "110", "--seed", "4", "--width", "320", "--height", "240"});
  folder_.Write("first.bag", DepthCameraBag(room, 0, 80));
  folder_.Write("second.bag", DepthCameraBag(room, 30, 110));
  EXPECT_THAT(CommandsIn("tutorial-depth-camera.md"), Contains(HasSubstr("alidade localize")));
  RunAll("tutorial-depth-camera.md");
  EXPECT_TRUE(Has("kitchen.ply"));
  AteSettings settings;
  settings.align = Alignment::kSe3;  // meters
  const Trajectory truth = ReadTrajectory(room + "/groundtruth.txt"),
                   mapped = ReadTrajectory(folder_ / "kitchen/trajectory.txt"),
                   found = ReadTrajectory(folder_ / "second/trajectory.txt");
  const AteResult of_map = EvaluateAte(truth, mapped, settings);
  EXPECT_LT(of_map.error.rmse, 0.02);
  EXPECT_GE(found.size(), 50u);
  // In the world of the map: with its alignment the second path is right too.
  double worst = 0;
  for (const StampedPose& pose : found) {
    for (const StampedPose& true_pose : truth) {
      if (std::abs(true_pose.time - pose.time) > 1e-4) continue;
      const Eigen::Vector3d there = of_map.T_truth_estimate * pose.T_world_camera.t;
      worst = std::max(worst, (there - true_pose.T_world_camera.t).norm());
    }
  }
  EXPECT_LT(worst, 0.05);
}

}  // namespace
}  // namespace alidade::tutorials_test
