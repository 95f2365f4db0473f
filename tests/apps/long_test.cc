// The accuracy goals on whole rendered recordings: minutes each, so only with scripts/test --long.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "alidade/io/files/trajectory_file.h"
#include "support/rendered.h"

namespace alidade::long_test {
namespace {

using nlohmann::json;

double PathLength(const Trajectory& trajectory) {
  double length = 0;
  for (size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].T_world_camera.t - trajectory[i - 1].T_world_camera.t).norm();
  }
  return length;
}

class LongRecording : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("ALIDADE_LONG_TESTS") == nullptr)
      GTEST_SKIP() << "only with scripts/test --long";
  }
  // Runs, expects every frame after the start to be tracked, and returns the ATE in metres.
  double RunAndMeasure(const std::string& recording, const std::string& sensor) {
    const std::string out = folder_ / sensor;
    const ProgramResult run =
        RunAlidade({"run", recording, "--sensor", sensor, "--out", out, "--quiet"});
    EXPECT_EQ(run.status, 0) << run.err;
    if (run.status != 0) return 1e9;
    const json stats = json::parse(ReadText(out + "/stats.json"));
    EXPECT_EQ(stats["tracked"].get<int>() + stats["initialized_at"].get<int>(), stats["frames"]);
    const ProgramResult ate = RunAlidade({"evaluate", "ate", recording, out, "--json", "--align",
                                          sensor == "mono" ? "sim3" : "se3"});
    EXPECT_EQ(ate.status, 0) << ate.err;
    return json::parse(ate.out)["rmse"].get<double>();
  }
  TempFolder folder_;
};

TEST_F(LongRecording, RoomWithDepth) {
  EXPECT_LE(RunAndMeasure(Rendered({"room", "--frames", "600"}), "rgbd"), 0.010);
}

TEST_F(LongRecording, RoomWithTwoCameras) {
  const std::string room = Rendered({"room", "--frames", "600", "--format", "euroc"});
  EXPECT_LE(RunAndMeasure(room, "stereo"), 0.012);
}

TEST_F(LongRecording, RoomWithOneCamera) {
  const std::string room = Rendered({"room", "--frames", "600"});
  EXPECT_LE(RunAndMeasure(room, "mono"), 0.005 * PathLength(ReadTrajectory(room)));
}

TEST_F(LongRecording, LoopsTakeTheDriftOut) {
  const std::string loop = Rendered({"loop", "--frames", "2000"});
  const double path = PathLength(ReadTrajectory(loop));
  EXPECT_GE(path, 40);
  EXPECT_LE(RunAndMeasure(loop, "mono"), 0.004 * path);
  EXPECT_GE(json::parse(ReadText(folder_ / "mono/stats.json"))["loops"], 1);
  EXPECT_LE(RunAndMeasure(loop, "rgbd"), 0.001 * path);
}

TEST_F(LongRecording, PlacesThatLookAlikeAreNotTakenForOneAnother) {
  for (const char* seed : {"1", "2", "3", "4", "5"}) {
    const std::string corridor = Rendered({"corridor", "--frames", "1000", "--seed", seed});
    EXPECT_LE(RunAndMeasure(corridor, "rgbd"), 0.005 * PathLength(ReadTrajectory(corridor)));
  }
}

class LongStart : public LongRecording,
                  public testing::WithParamInterface<std::tuple<std::string, std::string>> {};

TEST_P(LongStart, WithOneCameraIsNeverWrong) {
  const auto [scene, seed] = GetParam();
  const std::string recording = Rendered({scene, "--frames", "300", "--seed", seed});
  EXPECT_LE(RunAndMeasure(recording, "mono"), 0.01 * PathLength(ReadTrajectory(recording)));
}

INSTANTIATE_TEST_SUITE_P(DeskAndWall, LongStart,
                         testing::Combine(testing::Values("desk", "wall"),
                                          testing::Values("1", "2", "3", "4", "5")));

}  // namespace
}  // namespace alidade::long_test
