// Published results of TUM's tools and evo on fr1/xyz (under ALIDADE_DATA).
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/rpe.h"

namespace alidade::freiburg_test {
namespace {

class Freiburg1Xyz : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("ALIDADE_DATA");
    if (data == nullptr) GTEST_SKIP() << "ALIDADE_DATA is not set";
    folder_ = std::string(data) + "/trajectories/freiburg1_xyz-";
    truth_ = Read("groundtruth");
    rgbdslam_ = Read("rgbdslam");
  }
  Trajectory Read(const std::string& name) const {
    std::ifstream file(folder_ + name + ".txt");
    EXPECT_TRUE(file) << name;
    Trajectory trajectory;
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::istringstream fields(line);
      double time;
      Eigen::Vector3d t;
      Eigen::Quaterniond q;
      fields >> time >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
      EXPECT_TRUE(fields) << line;
      trajectory.push_back({time, Se3::FromQuaternion(q, t), ""});
    }
    return trajectory;
  }
  std::string folder_;
  Trajectory truth_, rgbdslam_;
};

constexpr double kDigits = 0.6e-6;  // the published values have six decimals

TEST_F(Freiburg1Xyz, AteOfRgbdSlamIsThatOfTumsTool) {
  const ErrorStatistics error = EvaluateAte(truth_, rgbdslam_).error;
  EXPECT_EQ(error.n, 786);
  EXPECT_NEAR(error.rmse, 0.013473, kDigits);
  EXPECT_NEAR(error.mean, 0.012029, kDigits);
  EXPECT_NEAR(error.median, 0.011176, kDigits);
  EXPECT_NEAR(error.std, 0.006068, kDigits);
}

TEST_F(Freiburg1Xyz, AteWithinTenMillisecondsLosesOnePair) {
  const ErrorStatistics error = EvaluateAte(truth_, rgbdslam_, {.max_dt = 0.01}).error;
  EXPECT_EQ(error.n, 785);
  EXPECT_NEAR(error.rmse, 0.013470, kDigits);
}

TEST_F(Freiburg1Xyz, AteWithScaleWithinTenMilliseconds) {
  const AteResult result =
      EvaluateAte(truth_, rgbdslam_, {.align = Alignment::kSim3, .max_dt = 0.01});
  EXPECT_NEAR(result.error.rmse, 0.013389, kDigits);
  EXPECT_NEAR(result.T_truth_estimate.s, 1.00800, 0.6e-5);
}

TEST_F(Freiburg1Xyz, AteOfMonocularKeyframesWithScale) {
  const AteResult result = EvaluateAte(truth_, Read("ORB_kf_mono"), {.align = Alignment::kSim3});
  EXPECT_EQ(result.error.n, 32);
  EXPECT_NEAR(result.error.rmse, 0.009755, kDigits);
  EXPECT_NEAR(result.T_truth_estimate.s, 1.105622, kDigits);
}

TEST_F(Freiburg1Xyz, RpeOverOneSecondIsThatOfTumsTool) {
  const RpeResult result = EvaluateRpe(truth_, rgbdslam_);
  EXPECT_EQ(result.trans.n, 753);
  EXPECT_NEAR(result.trans.rmse, 0.021554, kDigits);
  EXPECT_NEAR(result.rot.rmse, 0.934480, kDigits);
}

TEST_F(Freiburg1Xyz, CoverageCountsTheTruthOfTheRecordingsSpan) {
  // The ground truth is recorded at 100 Hz, the estimate at 30 Hz.
  EXPECT_NEAR(EvaluateAte(truth_, rgbdslam_).coverage, 0.3, 0.05);
  const AteResult whole = EvaluateAte(
      truth_, rgbdslam_, {.source_span = TimeSpan{truth_.front().time, truth_.back().time}});
  EXPECT_NEAR(whole.coverage, 786.0 / static_cast<double>(truth_.size()), 1e-9);
}

}  // namespace
}  // namespace alidade::freiburg_test
