// Harnesses of others: scripts/research/vslam-lab is called as VSLAM-LAB calls its baselines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/rendered.h"

namespace alidade::harness_test {
namespace {

// The scripts lie beside the folder the program was built in.
std::string Script(const std::string& name) {
  return std::filesystem::path(ALIDADE_BINARY).parent_path().parent_path().parent_path().string() +
         "/scripts/" + name;
}

std::vector<double> Numbers(std::string line) {
  for (char& c : line) c = c == ',' ? ' ' : c;
  std::istringstream in(line);
  std::vector<double> numbers;
  for (double number; in >> number;) numbers.push_back(number);
  return numbers;
}

TEST(VslamLab, GetsTheTrajectoryOfARunInItsOwnForm) {
  if (std::system("python3 -c 'import yaml' 2>/dev/null") != 0) GTEST_SKIP() << "no PyYAML here";
  const std::string recording =
      Rendered({"room", "--frames", "30", "--width", "320", "--height", "240"});
  const TempFolder folder;
  // Times in nanoseconds, and the camera, as VSLAM-LAB has them.
  std::vector<std::string> rows = {"ts_rgb_0 (ns),path_rgb_0,ts_depth_0 (ns),path_depth_0"};
  const std::vector<std::string> rgb = DataLines(recording + "/rgb.txt"),
                                 depth = DataLines(recording + "/depth.txt");
  ASSERT_EQ(rgb.size(), depth.size());
  const auto row = [](const std::string& line) {
    std::istringstream in(line);
    double time = 0;
    std::string name;
    in >> time >> name;
    return std::to_string(std::llround(time * 1e9)) + "," + name;
  };
  for (size_t i = 0; i < rgb.size(); ++i) rows.push_back(row(rgb[i]) + "," + row(depth[i]));
  WriteLines(folder / "rgb.csv", rows);
  const std::string camera = ReadText(recording + "/camera.yaml");
  const auto field = [&](const std::string& name) {
    const size_t at = camera.find("\n" + name + ":");
    return std::strtod(camera.c_str() + at + name.size() + 2, nullptr);
  };
  std::ostringstream calibration;
  calibration.precision(17);
  calibration
      << "%YAML:1.0\n---\ncameras:\n- {cam_name: rgb_0, cam_type: gray, cam_model: pinhole, "
      << "focal_length: [" << field("fx") << ", " << field("fy") << "], principal_point: ["
      << field("cx") << ", " << field("cy") << "], image_dimension: [320, 240], fps: 30, "
      << "depth_factor: " << field("depth_factor") << "}\n";
  folder.Write("calibration.yaml", calibration.str());
  const std::string command = "ALIDADE='" ALIDADE_BINARY "' '" + Script("research/vslam-lab") +
                              "' mode:rgbd sequence_path:'" + recording + "' calibration_yaml:'" +
                              (folder / "calibration.yaml") + "' rgb_csv:'" + (folder / "rgb.csv") +
                              "' exp_folder:'" + (folder / "exp") + "' exp_it:7";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::vector<std::string> lines = ReadLines(folder / "exp/00007_KeyFrameTrajectory.csv");
  ASSERT_GT(lines.size(), 1u);
  EXPECT_THAT(lines[0], testing::HasSubstr("ts (ns),tx (m),ty (m),tz (m),qx,qy,qz,qw"));
  ASSERT_EQ(RunAlidade({"run", recording, "--sensor", "rgbd", "--out", folder / "run"}).status, 0);
  const std::vector<std::string> poses = DataLines(folder / "run/trajectory.txt");
  ASSERT_EQ(lines.size(), poses.size() + 1);
  for (size_t i = 0; i < poses.size(); ++i) {
    const std::vector<double> theirs = Numbers(lines[i + 1]), ours = Numbers(poses[i]);
    EXPECT_NEAR(theirs[0], 1e9 * ours[0], 2);
    for (size_t k = 1; k < 8; ++k) EXPECT_EQ(theirs[k], ours[k]);
  }
}

}  // namespace
}  // namespace alidade::harness_test
