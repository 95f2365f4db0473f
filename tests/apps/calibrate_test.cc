// Cameras that nobody calibrated, through the program as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/io/files/camera_file.h"
#include "alidade/io/trajectory.h"
#include "alidade/map/map_file.h"
#include "support/program.h"

namespace alidade::calibrate_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Small, so that it renders fast; of 320 columns, 75 degrees are 208.5 px.
constexpr char kDesk[] = "synth:desk?frames=160&width=320&height=240&fov=75&k1=-0.1";
const double kFocal = 160 / std::tan(37.5 * M_PI / 180);

json Stats(const std::string& folder) { return json::parse(ReadText(folder + "/stats.json")); }

// The folder of a run of the desk with one camera that nobody knows, of which the first call makes
// it.
const std::string& FoundResult(ProgramResult* run = nullptr) {
  static const TempFolder out;
  static const std::string found = out / "found";
  static const ProgramResult result =
      RunAlidade({"run", std::string(kDesk) + "&calibrated=0", "--sensor", "mono", "--out", found});
  EXPECT_EQ(result.status, 0) << result.err;
  if (run != nullptr) *run = result;
  return found;
}

double AteOf(const std::string& folder) {
  const ProgramResult result =
      RunAlidade({"evaluate", "ate", folder + "/groundtruth.txt", folder + "/trajectory.txt",
                  "--align", "sim3", "--json"});
  return json::parse(result.out)["rmse"].get<double>();
}

TEST(Calibrate, AnUnknownCameraIsFoundBeforeTheRunAndLeftForTheNext) {
  const TempFolder out;
  ProgramResult run;
  const std::string& found = FoundResult(&run);
  EXPECT_THAT(run.out, HasSubstr("Camera estimated: "));
  const json stats = Stats(found);
  const json& camera = stats["camera"];
  EXPECT_EQ(camera["known"], "estimated");
  const double sigma = camera["fx_sigma"];
  EXPECT_LT(sigma, 0.01 * kFocal);
  EXPECT_NEAR(camera["fx"].get<double>(), kFocal, std::min(3 * sigma, 0.02 * kFocal));
  EXPECT_NEAR(camera["distortion"][0].get<double>(), -0.1, 0.03);
  EXPECT_GE(stats["calibration"]["passes"].get<int>(), 2);  // 66 degrees are far from 75
  EXPECT_THAT(ReadText(found + "/report.html"), HasSubstr("estimated from the recording"));

  // What it wrote is the camera it ran with, to the last bit.
  const ProgramResult again =
      RunAlidade({"run", std::string(kDesk) + "&calibrated=0", "--sensor", "mono", "--camera",
                  found + "/camera.yaml", "--out", out / "told"});
  ASSERT_EQ(again.status, 0) << again.err;
  const json told = Stats(out / "told");
  EXPECT_EQ(told["camera"]["known"], "given");
  EXPECT_EQ(told["camera"]["fx"], camera["fx"]);
  EXPECT_EQ(told["camera"]["distortion"], camera["distortion"]);
  EXPECT_TRUE(told["camera"]["fx_sigma"].is_null());
  EXPECT_TRUE(told["calibration"].is_null());

  // As good as with the true camera, or nearly.
  const ProgramResult known =
      RunAlidade({"run", kDesk, "--sensor", "mono", "--out", out / "known"});
  ASSERT_EQ(known.status, 0) << known.err;
  EXPECT_EQ(Stats(out / "known")["camera"]["known"], "file");
  EXPECT_FALSE(std::filesystem::exists(out / "known/camera.yaml"));
  EXPECT_LT(AteOf(found), 1.3 * AteOf(out / "known") + 0.0005);
}

TEST(Calibrate, GoesOnInAMapWithTheCameraItWasMadeWith) {
  const TempFolder out;
  const std::string unknown = std::string(kDesk) + "&calibrated=0";
  const std::string& first = FoundResult();
  const ProgramResult more = RunAlidade({"run", unknown, "--sensor", "mono", "--load",
                                         first + "/map.alidade", "--out", out / "more"});
  ASSERT_EQ(more.status, 0) << more.err;
  EXPECT_NEAR(Stats(out / "more")["camera"]["fx"].get<double>(),
              Stats(first)["camera"]["fx"].get<double>(), 1e-9);
  EXPECT_TRUE(Stats(out / "more")["calibration"].is_null());
}

TEST(Calibrate, ATurnOnTheSpotSaysThatItDoesNotKnow) {
  const TempFolder out;
  const std::string turn = "synth:room?frames=90&width=320&height=240&path=turn&calibrated=0";
  const ProgramResult run = RunAlidade({"run", turn, "--sensor", "mono", "--out", out / "turn"});
  EXPECT_EQ(run.status, 4);
  EXPECT_THAT(run.err, HasSubstr("the camera could not be calibrated"));
  EXPECT_EQ(Stats(out / "turn")["camera"]["known"], "assumed");
  const ProgramResult calibrate = RunAlidade({"calibrate", turn, "--out", out / "camera.yaml"});
  EXPECT_EQ(calibrate.status, 4);
  EXPECT_THAT(calibrate.err, HasSubstr("sideways"));
  EXPECT_FALSE(std::filesystem::exists(out / "camera.yaml"));
}

TEST(Calibrate, WhatIsGivenIsNotLookedFor) {
  const TempFolder out;
  const std::string few = "synth:desk?frames=30&width=320&height=240&calibrated=0";
  ASSERT_EQ(RunAlidade({"run", few, "--sensor", "mono", "--fov", "75", "--out", out / "a"}).status,
            0);
  EXPECT_EQ(Stats(out / "a")["camera"]["known"], "given");
  EXPECT_NEAR(Stats(out / "a")["camera"]["fx"].get<double>(), kFocal, 1e-9);
  const ProgramResult off =
      RunAlidade({"run", few, "--sensor", "mono", "--no-calibrate-first", "--out", out / "b"});
  ASSERT_EQ(off.status, 0) << off.err;  // looked for on the way
  EXPECT_EQ(Stats(out / "b")["camera"]["known"], "assumed");
  EXPECT_THAT(Stats(out / "b")["calibration"]["why_not"], HasSubstr("too little"));
  EXPECT_THAT(off.err, HasSubstr("66.0 degrees is assumed"));
  const ProgramResult never = RunAlidade(
      {"run", few, "--sensor", "mono", "--set", "calibrate.enabled=0", "--out", out / "d"});
  ASSERT_EQ(never.status, 0) << never.err;
  EXPECT_TRUE(Stats(out / "d")["calibration"].is_null());
  EXPECT_THAT(never.err, HasSubstr("66.0 degrees is assumed"));
  for (const char* wrong : {"~", "x", "0", "~200"}) {
    const ProgramResult bad = RunAlidade({"run", few, "--fov", wrong, "--out", out / "c"});
    EXPECT_EQ(bad.status, 2) << wrong;
    EXPECT_THAT(bad.err, HasSubstr("--fov"));
  }
}

TEST(Calibrate, OnTheWayInOnePass) {
  const TempFolder out;
  const ProgramResult run = RunAlidade({"run", std::string(kDesk) + "&calibrated=0", "--sensor",
                                        "mono", "--no-calibrate-first", "--out", out / "a"});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto stats = Stats(out / "a");
  EXPECT_NEAR(stats["camera"]["fx"].get<double>(), kFocal, 0.02 * kFocal);
  EXPECT_EQ(stats["calibration"]["passes"], 1);
  EXPECT_NEAR(ReadCameraFile(out / "a/camera.yaml").left.fx, kFocal, 0.02 * kFocal);
  EXPECT_NEAR(DecodeMap(ReadText(out / "a/map.alidade")).camera.fx, kFocal, 0.02 * kFocal);
}

TEST(Calibrate, SeveralRecordingsOfOneCameraKnowMoreTogether) {
  const TempFolder out;
  const ProgramResult run =
      RunAlidade({"calibrate", kDesk, std::string(kDesk) + "&seed=2", "--out", out / "phone.yaml"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("together: "));
  const Calibration found = ReadCameraFile(out / "phone.yaml");
  EXPECT_NEAR(found.left.fx, kFocal, 0.015 * kFocal);
  EXPECT_EQ(found.left.width, 320);
  const ProgramResult mixed = RunAlidade(
      {"calibrate", kDesk, "synth:desk?frames=60&width=400&height=300", "--out", out / "x.yaml"});
  EXPECT_EQ(mixed.status, 3);
  EXPECT_THAT(mixed.err, HasSubstr("another size"));
}

TEST(Calibrate, ARollingShutterIsFoundWithTheLens) {
  const TempFolder out;
  const ProgramResult run = RunAlidade(
      {"calibrate", std::string(kDesk) + "&rolling_shutter=25", "--out", out / "phone.yaml"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(", readout time "));
  const Calibration found = ReadCameraFile(out / "phone.yaml");
  EXPECT_NEAR(found.left.fx, kFocal, 0.015 * kFocal);
  ASSERT_TRUE(found.readout.has_value());
  EXPECT_NEAR((*found.readout)[1], 0.025, 0.006);
  EXPECT_EQ((*found.readout)[0], 0);
  EXPECT_NEAR(found.left.cy, 119.5, 3.6);  // what it is mistaken for where it is not looked for
}

}  // namespace
}  // namespace alidade::calibrate_test
