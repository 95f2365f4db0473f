// `alidade evaluate` as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "support/program.h"

namespace alidade::evaluate_command_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// A circle of radius 1, ten poses a second, drawn `scale` times as large.
std::string Circle(int poses, double scale = 1) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i < poses; ++i) {
    char line[200];
    std::snprintf(line, sizeof(line), "%.3f %.9f %.9f 0 0 0 0 1\n", 0.1 * i,
                  scale * std::cos(0.1 * i), scale * std::sin(0.1 * i));
    text += line;
  }
  return text;
}

class EvaluateCommand : public testing::Test {
 protected:
  json Json(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "evaluate");
    arguments.push_back("--json");
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false);
  }
  TempFolder folder_;
  std::string truth_ = folder_.Write("truth.txt", Circle(60));
  std::string twice_ = folder_.Write("twice.txt", Circle(60, 2));
};

TEST_F(EvaluateCommand, AteGivesEveryNumberOfTheContract) {
  const json ate = Json({"ate", truth_, twice_, "--align", "sim3"});
  for (const char* name :
       {"n", "rmse", "mean", "median", "std", "min", "max", "scale", "coverage"}) {
    EXPECT_TRUE(ate.contains(name)) << name;
  }
  EXPECT_EQ(ate["n"], 60);
  EXPECT_NEAR(ate["scale"].get<double>(), 0.5, 1e-6);
  EXPECT_LT(ate["rmse"].get<double>(), 1e-6);
  EXPECT_EQ(ate["coverage"], 1);
  // Unaligned, every point is 1 m off.
  EXPECT_NEAR(Json({"ate", truth_, twice_, "--align", "none"})["rmse"].get<double>(), 1, 1e-6);
}

TEST_F(EvaluateCommand, RpeGivesTranslationAndRotation) {
  const json rpe = Json({"rpe", truth_, twice_, "--delta", "10f"});
  const double chord = 2 * std::sin(0.5);  // of one radian on the unit circle: ten frames
  EXPECT_NEAR(rpe["trans"]["rmse"].get<double>(), chord, 1e-6);
  EXPECT_NEAR(rpe["rot"]["max"].get<double>(), 0, 1e-6);
  EXPECT_EQ(rpe["trans"]["n"], 49);
  EXPECT_EQ(Json({"rpe", truth_, truth_, "--pairs", "consecutive"})["rot"]["n"], 5);
}

TEST_F(EvaluateCommand, CoverageKnowsTheRecordingBesideTheTruth) {
  std::string list = "# timestamp filename\n";
  for (int i = 0; i < 60; ++i) list += std::to_string(0.1 * i) + " rgb/x.png\n";
  folder_.Write("rgb.txt", list);
  const std::string half = folder_.Write("result/trajectory.txt", Circle(30));
  EXPECT_EQ(Json({"ate", truth_, half})["coverage"], 0.5);
  // What `run` says of the part it was given goes before.
  folder_.Write("result/stats.json", R"({"span": [0, 2.9]})");
  EXPECT_EQ(Json({"ate", truth_, half})["coverage"], 1);
}

TEST_F(EvaluateCommand, AResultBeforeTheTruthIsTold) {
  const std::string mono = folder_.Write("mono/trajectory.txt", Circle(60, 2));
  folder_.Write("mono/stats.json", R"({"sensor": "mono"})");
  EXPECT_THAT(RunAlidade({"evaluate", "ate", mono, truth_}).err, HasSubstr("swapped?"));
  EXPECT_THAT(RunAlidade({"evaluate", "ate", truth_, mono}).err, Not(HasSubstr("swapped")));
  EXPECT_THAT(RunAlidade({"evaluate", "ate", mono, mono}).err, Not(HasSubstr("swapped")));
}

// What `run` notes of its sensor says whether the estimate has a scale of its own.
TEST_F(EvaluateCommand, OneCamerasResultIsScaledUnlessItIsSaidOtherwise) {
  const std::string mono = folder_.Write("mono/trajectory.txt", Circle(60, 2));
  const std::string deep = folder_.Write("deep/trajectory.txt", Circle(60, 2));
  folder_.Write("mono/stats.json", R"({"sensor": "mono", "span": [0, 5.9]})");
  folder_.Write("deep/stats.json", R"({"sensor": "rgbd", "span": [0, 5.9]})");
  for (const std::string& estimate : {mono, folder_ / "mono"}) {
    const json ate = Json({"ate", truth_, estimate});
    EXPECT_LT(ate["rmse"].get<double>(), 1e-6);
    EXPECT_NEAR(ate["scale"].get<double>(), 0.5, 1e-6);
    EXPECT_EQ(ate["align"], "sim3");
    const json rpe = Json({"rpe", truth_, estimate, "--delta", "10f"});
    EXPECT_LT(rpe["trans"]["rmse"].get<double>(), 1e-6);
    EXPECT_EQ(rpe["align"], "sim3");
  }
  for (const std::string& estimate : {deep, twice_}) {  // of the latter nobody says what it is
    EXPECT_GT(Json({"ate", truth_, estimate})["rmse"].get<double>(), 0.5);
    EXPECT_EQ(Json({"ate", truth_, estimate})["align"], "se3");
    EXPECT_EQ(Json({"rpe", truth_, estimate})["align"], "se3");
  }
  EXPECT_GT(Json({"ate", truth_, mono, "--align", "se3"})["rmse"].get<double>(), 0.5);
  // And the table says what was done, why, and which scale there would be.
  const auto table = [&](const std::string& command, const std::string& estimate) {
    return RunAlidade({"evaluate", command, truth_, estimate}).out;
  };
  for (const char* command : {"ate", "rpe"}) {
    EXPECT_THAT(table(command, mono), HasSubstr("aligned by Sim(3) (one camera), scale 0.500000"));
    EXPECT_THAT(table(command, deep),
                HasSubstr("aligned by SE(3) (depth or stereo); Sim(3) would scale by 0.500000"));
    EXPECT_THAT(table(command, twice_),
                HasSubstr("aligned by SE(3) (unknown sensor; sim3 is for one camera); Sim(3) would "
                          "scale by 0.500000"));
  }
  EXPECT_THAT(RunAlidade({"evaluate", "ate", truth_, twice_, "--align", "sim3"}).out,
              HasSubstr("aligned by Sim(3) (--align), scale 0.500000"));
}

TEST_F(EvaluateCommand, TableIsForPeople) {
  const ProgramResult result = RunAlidade({"evaluate", "ate", truth_, twice_});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("60 of 60 poses matched"));
  EXPECT_THAT(result.out, HasSubstr("rmse"));
}

TEST_F(EvaluateCommand, InputThatCannotBeIsOneLineAndStatusThree) {
  const std::string broken = folder_.Write("broken.txt", "0 1 2 3 0 0 0 1\n1 nan 2 3 0 0 0 1\n");
  const std::string still =
      folder_.Write("still.txt", "0 1 1 1 0 0 0 1\n0.1 1 1 1 0 0 0 1\n0.2 1 1 1 0 0 0 1\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {folder_ / "nowhere.txt", "nowhere.txt"},
      {folder_.Write("empty.txt", ""), "empty.txt"},
      {broken, "broken.txt:2"},
      {still, "same point"},
      {folder_.Write("two.txt", Circle(2)), "3 are needed"}};
  for (const auto& [estimate, words] : cases) {
    const ProgramResult result = RunAlidade({"evaluate", "ate", truth_, estimate});
    EXPECT_EQ(result.status, 3) << estimate;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
  }
}

TEST_F(EvaluateCommand, OptionsThatCannotBeAreUsageErrors) {
  for (const std::vector<std::string>& options : {std::vector<std::string>{"--delta", "1"},
                                                  {"--delta", "0s"},
                                                  {"--delta", "1.5f"},
                                                  {"--max-dt", "-1"},
                                                  {"--max-dt", "nan"},
                                                  {"--max-dt", "soon"}}) {
    std::vector<std::string> arguments = {"evaluate", "rpe", truth_, truth_};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 2) << options[1];
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
  }
}

}  // namespace
}  // namespace alidade::evaluate_command_test
