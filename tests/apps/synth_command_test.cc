// `alidade synth`: what it writes is a recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "support/program.h"

namespace alidade::synth_command_test {
namespace {

long LinesOf(const std::string& file) {
  const std::string text = ReadText(file);
  return std::count(text.begin(), text.end(), '\n');
}

TEST(SynthCommand, WhatTheCommandWritesIsRenderedAgainForItsDepth) {
  const TempFolder folder;
  const std::string made = folder / "made", out = folder / "out";
  const ProgramResult written = RunAlidade(
      {"synth", "desk", made, "--frames", "3", "--path", "still", "--things", "1", "--width", "320",
       "--height", "240", "--blur=35", "--rolling-shutter", "10", "--light", "0.5"});
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_NE(ReadText(made + "/synth.json").find("\"path\": \"still\""), std::string::npos);
  // Depth of a recording is compared with itself, rendered anew.
  const ProgramResult run = RunAlidade({"run", made, "--semidense", "--out", out});
  ASSERT_EQ(run.status, 0) << run.err;
  const ProgramResult depth = RunAlidade({"evaluate", "depth", made, out});
  EXPECT_EQ(depth.status, 0) << depth.err;
}

// The clock of EuRoC's recordings is one, and their sensor is known.
TEST(SynthCommand, WritesReadingsInTheFormOfTheRecording) {
  const TempFolder folder;
  const std::string made = folder / "made";
  const auto written = [&](const std::vector<std::string>& options) {
    std::vector<std::string> all = {"synth",   "table", made,       "--frames", "4",
                                    "--width", "160",   "--height", "120"};
    all.insert(all.end(), options.begin(), options.end());
    return RunAlidade(all).status;
  };
  ASSERT_EQ(written({"--imu", "phone", "--imu-rate", "200"}), 0);
  // 3 frames later, and 0.1 s at either end.
  EXPECT_NEAR(static_cast<double>(LinesOf(made + "/imu.csv")), 1 + 200 * 0.3, 2);
  EXPECT_EQ(LinesOf(made + "/motion.csv"), LinesOf(made + "/imu.csv"));
  const std::string camera = ReadText(made + "/camera.yaml");
  EXPECT_NE(camera.find("imu:\n  rate: 200\n"), std::string::npos);
  EXPECT_EQ(camera.find("T_camera_imu"), std::string::npos);
  EXPECT_EQ(written({"--imu", "phone", "--format", "euroc"}), 2);
  EXPECT_EQ(written({"--imu", "adis", "--format", "kitti"}), 2);
  ASSERT_EQ(written({"--imu", "adis", "--imu-offset", "5"}), 0);
  EXPECT_FALSE(std::filesystem::exists(made + "/motion.csv"));
  EXPECT_NE(ReadText(made + "/camera.yaml").find("time_offset: 0.005"), std::string::npos);
  ASSERT_EQ(written({"--imu", "adis", "--format", "euroc"}), 0);
  EXPECT_FALSE(std::filesystem::exists(made + "/imu.csv"));
  EXPECT_NEAR(static_cast<double>(LinesOf(made + "/mav0/imu0/data.csv")), 1 + 200 * 0.3, 2);
  EXPECT_NE(ReadText(made + "/mav0/imu0/sensor.yaml").find("gyroscope_noise_density: 0.00017"),
            std::string::npos);
}

}  // namespace
}  // namespace alidade::synth_command_test
