// What `run --semidense` writes is right, or it writes nothing: where the camera hardly moves
// nothing can be known.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "support/program.h"

namespace alidade::semidense_truth_test {
namespace {

using nlohmann::json;

class SemiDenseTruth : public testing::Test {
 protected:
  // What `evaluate depth` says of a mono run.
  json Score(const std::string& source) {
    const std::string out = folder_ / "out";
    const ProgramResult run =
        RunAlidade({"run", source, "--sensor", "mono", "--semidense", "--out", out, "--quiet"});
    EXPECT_TRUE(run.status == 0 || run.status == 4) << run.err;
    const ProgramResult score = RunAlidade({"evaluate", "depth", source, out, "--json"});
    EXPECT_EQ(score.status, 0) << score.err;
    return json::parse(score.out, nullptr, false);
  }
  TempFolder folder_;
};

// The camera turns on its feet: of landmarks triangulated from a few centimetres half are wrong by
// half their depth.
TEST_F(SemiDenseTruth, ATurningCameraLeavesNoWrongDepth) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const json score = Score(DataFolder() + "/fr1_rpy");
  ASSERT_TRUE(score.contains("n"));
  if (score["n"] > 0) {
    EXPECT_LT(score["median_rel"], 0.05);
  }
}

TEST_F(SemiDenseTruth, ARealRoomIsAsItsDepthCameraSawIt) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const json score = Score(DataFolder() + "/kitchen");
  ASSERT_TRUE(score.contains("n"));
  EXPECT_LT(score["median_rel"], 0.025);  // the sensor's calibration is no better than a percent
  EXPECT_GT(score["within_5"], 0.8);
  EXPECT_GT(score["density"], 0.05);
}

}  // namespace
}  // namespace alidade::semidense_truth_test
