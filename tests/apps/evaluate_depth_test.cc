// `alidade evaluate depth` as a user meets it, on results made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/synth/recording.h"
#include "support/program.h"
#include "support/rendered.h"
#include "support/tiny_recording.h"

namespace alidade::evaluate_depth_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// What `run --semidense` leaves of one map: stamps and depth in the map's unit.
void WriteResult(const TempFolder& folder, const std::string& sensor,
                 const std::map<std::string, cv::Mat1f>& depths,
                 const std::string& list = "result/depth.txt") {
  folder.Folder("result/depth");
  std::string lines = "# timestamp file\n";
  for (const auto& [stamp, depth] : depths) {
    cv::Mat stored;
    depth.convertTo(stored, CV_16U, 5000);
    WriteImage(folder / ("result/depth/" + stamp + ".png"), stored);
    lines += stamp + " depth/" + stamp + ".png\n";
  }
  folder.Write(list, lines);
  folder.Write("result/stats.json", R"({"version": 1, "sensor": ")" + sensor + "\"}");
}

cv::Mat1f Plain(float z) { return cv::Mat1f(kTinyHeight, kTinyWidth, z); }

class EvaluateDepth : public testing::Test {
 protected:
  json Json(const std::string& sequence, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"evaluate", "depth", sequence, result_, "--json"});
    const ProgramResult result = RunAlidade(options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, testing::Not(HasSubstr("nan")));
    warnings_ = result.err;
    return json::parse(result.out, nullptr, false);
  }
  // Runs into an error of the input: one line, status 3.
  std::string Complaint(const std::string& sequence, const std::string& result_folder) {
    const ProgramResult result = RunAlidade({"evaluate", "depth", sequence, result_folder});
    EXPECT_EQ(result.status, 3);
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_EQ(result.out, "");
    return result.err;
  }
  TempFolder folder_;
  std::string result_ = folder_ / "result";
  std::string warnings_;
};

TEST_F(EvaluateDepth, GivesEveryNumberOfTheContract) {
  WriteTinyTum(folder_);  // frame i is 1 + 0.001 i metres deep
  WriteResult(folder_, "rgbd",
              {{TinyStamp(1), 1.03 * Plain(1.001f)}, {TinyStamp(3), 1.03 * Plain(1.003f)}});
  const json depth = Json(folder_.path());
  for (const json& scores : {depth, depth["all"], depth["continuous"]}) {
    EXPECT_EQ(scores["n"], 2 * kTinyWidth * kTinyHeight);
    EXPECT_NEAR(scores["median_rel"].get<double>(), 0.03, 2e-4);  // 1 in 5000
    EXPECT_NEAR(scores["p90_rel"].get<double>(), 0.03, 2e-4);
    EXPECT_EQ(scores["within_2"], 0);
    EXPECT_EQ(scores["within_5"], 1);
    EXPECT_EQ(scores["within_10"], 1);
    EXPECT_NEAR(scores["rmse_inv"].get<double>(), (1 - 1 / 1.03) / 1.002, 2e-4);
    EXPECT_EQ(scores["density"], 1);
    EXPECT_EQ(scores["density_gradient"], 1);
    EXPECT_EQ(scores["edge_coverage"], 1);
    EXPECT_EQ(scores["scale"], 1);
  }
  EXPECT_EQ(depth["truth"], "sensor");
  EXPECT_EQ(depth["pixels"], "continuous");
  ASSERT_EQ(depth["keyframes"].size(), 2u);
  EXPECT_EQ(depth["keyframes"][1]["stamp"], TinyStamp(3));
  EXPECT_EQ(depth["keyframes"][1]["n"], kTinyWidth * kTinyHeight);
  EXPECT_EQ(warnings_, "");
}

TEST_F(EvaluateDepth, OneCamerasScaleIsFittedForEachMap) {
  WriteTinyTum(folder_);
  WriteResult(folder_, "mono", {{TinyStamp(4), Plain(1.004f / 5)}}, "result/depth.1.txt");
  WriteResult(folder_, "mono",
              {{TinyStamp(0), Plain(1.0f / 2)}, {TinyStamp(2), Plain(1.002f / 2)}});
  const json fitted = Json(folder_.path());
  EXPECT_EQ(fitted["n"], 3 * kTinyWidth * kTinyHeight);
  EXPECT_NEAR(fitted["scale"].get<double>(), 2, 1e-3);
  EXPECT_NEAR(fitted["scales"][1].get<double>(), 5, 5e-3);
  EXPECT_LT(fitted["p90_rel"].get<double>(), 1e-3);
  EXPECT_EQ(fitted["keyframes"][2]["map"], 1);
  EXPECT_NEAR(fitted["keyframes"][2]["scale"].get<double>(), 5, 5e-3);
  const json plain = Json(folder_.path(), {"--scale", "none"});
  EXPECT_EQ(plain["scale"], 1);
  EXPECT_NEAR(plain["median_rel"].get<double>(), 0.5, 1e-3);
}

TEST_F(EvaluateDepth, RenderedTruthIsExactAndOnlyTheFramesAskedForAreNeeded) {
  SynthSettings settings;
  settings.frames = 40;
  settings.width = 160;
  settings.height = 120;
  settings.distortion = true;
  const SynthRecording recording(settings);
  std::map<std::string, cv::Mat1f> depths;
  for (const int i : {3, 17, 39}) {
    char stamp[32];
    std::snprintf(stamp, sizeof(stamp), "%.6f", recording.Time(i));
    depths[stamp] = 0.97 * recording.Render(i).depth_exact / 2;  // in a unit of 2 m
  }
  WriteResult(folder_, "rgbd", depths);
  const std::string source = "synth:room?frames=40&width=160&height=120&distortion";
  const json depth = Json(source, {"--scale", "fit"});
  EXPECT_EQ(depth["truth"], "rendered");
  EXPECT_EQ(depth["pixels"], "all");
  EXPECT_NEAR(depth["scale"].get<double>(), 2 / 0.97, 1e-4);
  EXPECT_LT(depth["p90_rel"].get<double>(), 1e-3);  // no error but that of 16 bits
  EXPECT_EQ(depth["all"]["n"], 3 * 160 * 120);
  EXPECT_LT(depth["continuous"]["n"], depth["all"]["n"]);
  // The same recording on disk, whose depth images have a sensor's faults, is judged alike.
  const std::vector<std::string> on_disk = {"room", "--frames", "40",  "--width",
                                            "160",  "--height", "120", "--distortion"};
  EXPECT_EQ(Json(Rendered(on_disk), {"--scale", "fit"}), depth);
}

TEST_F(EvaluateDepth, ASensorsDepthScoresPerfectlyAgainstItselfButNotAgainstTheTruth) {
  const std::string recording =
      Rendered({"room", "--frames", "3", "--width", "160", "--height", "120"});
  const std::string copy = CopyOf(recording, folder_);
  std::filesystem::copy(copy + "/depth", folder_.Folder("result") + "/depth");
  std::filesystem::copy(copy + "/depth.txt", result_ + "/depth.txt");
  folder_.Write("result/stats.json", R"({"sensor": "rgbd"})");
  const json against_truth = Json(copy);
  EXPECT_GT(against_truth["p90_rel"].get<double>(), 0.001);
  // 0.11 pixels of disparity at a focal length of 131 and a base of 0.075 m: 1.1 % per metre.
  EXPECT_LT(against_truth["median_rel"].get<double>(), 0.05);
  std::filesystem::remove(copy + "/synth.json");
  const json against_itself = Json(copy);
  EXPECT_EQ(against_itself["truth"], "sensor");
  EXPECT_LT(against_itself["p90_rel"].get<double>(), 1e-6);
  EXPECT_LT(against_itself["density"].get<double>(), 1);  // a sensor has holes
}

TEST_F(EvaluateDepth, DepthOfASmallerProfileIsTakenAsItIs) {
  WriteTinyTum(folder_);
  cv::Mat1f small(kTinyHeight / 2, kTinyWidth / 2, 1.001f);
  small.rowRange(0, 6) = 0;
  WriteResult(folder_, "rgbd", {{TinyStamp(1), small}});
  const json depth = Json(folder_.path());
  EXPECT_EQ(depth["n"], 18 * 32);
  EXPECT_EQ(depth["density"], 0.75);
  EXPECT_EQ(depth["within_2"], 1);
}

TEST_F(EvaluateDepth, NothingToldIsNullNotAnError) {
  WriteTinyTum(folder_);
  WriteResult(folder_, "mono", {{TinyStamp(1), Plain(0)}});
  const json empty = Json(folder_.path());
  EXPECT_EQ(empty["n"], 0);
  EXPECT_EQ(empty["density"], 0);
  for (const char* name : {"median_rel", "p90_rel", "within_5", "rmse_inv", "scale"})
    EXPECT_TRUE(empty[name].is_null()) << name;
  WriteResult(folder_, "mono", {});
  const json none = Json(folder_.path());
  EXPECT_EQ(none["n"], 0);
  EXPECT_TRUE(none["density"].is_null());
  EXPECT_EQ(none["keyframes"].size(), 0u);
  // A run that was asked for depth and could tell none leaves no list.
  std::filesystem::remove(result_ + "/depth.txt");
  folder_.Write("result/stats.json", R"({"sensor": "mono", "settings": {"semidense.enabled": 1}})");
  EXPECT_EQ(Json(folder_.path())["n"], 0);
  // Of two maps only the other may have depth; the main one's scale is not known then.
  WriteResult(folder_, "mono", {{TinyStamp(4), Plain(1.004f / 5)}}, "result/depth.1.txt");
  const json other = Json(folder_.path());
  EXPECT_EQ(other["within_2"], 1);
  EXPECT_TRUE(other["scale"].is_null());
}

TEST_F(EvaluateDepth, KeyframesWithoutTruthAreLeftOutAndCounted) {
  WriteTinyTum(folder_);
  WriteLines(folder_ / "depth.txt", {TinyStamp(1) + " depth/" + TinyStamp(1) + ".png"});
  WriteResult(folder_, "rgbd",
              {{TinyStamp(1), Plain(1)}, {TinyStamp(2), Plain(1)}, {"300.0", Plain(1)}});
  const json depth = Json(folder_.path());
  EXPECT_EQ(depth["keyframes"].size(), 1u);
  EXPECT_THAT(warnings_, HasSubstr("1 of 3 keyframes have no frame of the same time"));
  EXPECT_THAT(warnings_, HasSubstr("1 of 3 keyframes have no true depth"));
}

TEST_F(EvaluateDepth, TableIsForPeople) {
  WriteTinyTum(folder_);
  WriteResult(folder_, "mono", {{TinyStamp(1), Plain(0.5)}});
  const ProgramResult result = RunAlidade({"evaluate", "depth", folder_.path(), result_});
  EXPECT_EQ(result.status, 0);
  for (const char* words : {"1 keyframes, scaled (one camera) by 2.0", "all pixels",
                            "depth-continuous", "median", "of edges", "101.500000"})
    EXPECT_THAT(result.out, HasSubstr(words));
  EXPECT_THAT(RunAlidade({"evaluate", "depth", "--help"}).out, HasSubstr("Examples"));
}

TEST_F(EvaluateDepth, InputThatCannotBeIsOneLineAndStatusThree) {
  WriteTinyTum(folder_);
  const std::string sequence = folder_.path();
  EXPECT_THAT(Complaint(sequence, folder_ / "nowhere"), HasSubstr("contains no depth.txt"));
  WriteResult(folder_, "rgbd", {{TinyStamp(1), Plain(1)}});
  EXPECT_THAT(Complaint(folder_ / "nowhere", result_), HasSubstr("nowhere"));

  const TempFolder no_depth;
  WriteTinyTum(no_depth, {.depth = false});
  EXPECT_THAT(Complaint(no_depth.path(), result_), HasSubstr("no depth"));

  folder_.Write("result/stats.json", "{}");
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr("--scale"));
  folder_.Write("result/stats.json", "not json");
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr("--scale"));

  WriteResult(folder_, "rgbd", {{"7.5", Plain(1)}});
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr("same recording"));
  folder_.Write("result/depth.txt", "soon depth/7.5.png\n");
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr("depth.txt:1"));
  folder_.Write("result/depth.txt", TinyStamp(1) + " depth/gone.png\n");
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr("gone.png"));

  const std::string picture = "result/depth/" + TinyStamp(1) + ".png";
  WriteResult(folder_, "rgbd", {{TinyStamp(1), Plain(1)}});
  const std::string whole = ReadText(folder_ / picture);
  folder_.Write(picture, whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr(TinyStamp(1) + ".png"));
  WriteResult(folder_, "rgbd", {{TinyStamp(1), cv::Mat1f(48, 48, 1.f)}});
  EXPECT_THAT(Complaint(sequence, result_), HasSubstr("48x48 does not fit"));
}

TEST_F(EvaluateDepth, OptionsThatCannotBeAreUsageErrors) {
  WriteTinyTum(folder_);
  WriteResult(folder_, "rgbd", {{TinyStamp(1), Plain(1)}});
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--scale", "big"}, {"--max-dt", "0"}, {"--max-dt", "nan"}}) {
    std::vector<std::string> arguments = {"evaluate", "depth", folder_.path(), result_};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 2) << options[1];
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
  }
}

}  // namespace
}  // namespace alidade::evaluate_depth_test
