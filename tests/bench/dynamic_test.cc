// `alidade-bench dynamic`: that its figures are those the other commands give, and that it says
// what it cannot do. How good they are is nobody's to assert here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/io/files/image_file.h"
#include "bench/bench_result.h"
#include "support/rendered.h"

namespace alidade::bench_dynamic_test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr char kFrames[] = "24";

class BenchDynamic : public testing::Test {
 protected:
  static std::string Recording() {
    return Rendered({"desk", "--frames", kFrames, "--actors", "2", "--seed", "3"});
  }

  static json Bench(std::vector<std::string> words) {
    words.insert(words.begin(), "dynamic");
    return BenchResult(words);
  }

  // What `alidade evaluate` says of a run of `alidade run` in that mode.
  json Evaluate(const std::string& what, const std::string& mode) {
    const std::string results = folder_ / ("run-" + mode);
    if (!fs::exists(results)) {
      const ProgramResult run = RunAlidade({"run", Recording(), "--sensor", "rgbd", "--dynamics",
                                            mode, "--quiet", "--out", results});
      EXPECT_EQ(run.status, 0) << run.err;
    }
    const ProgramResult result = RunAlidade({"evaluate", what, Recording(), results, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false);
  }

  TempFolder folder_;
};

TEST_F(BenchDynamic, GivesTheErrorsThatEvaluateGives) {
  const json bench = Bench(
      {Recording(), "--sensor", "rgbd", "--no-live", "--set", "expert.dynamics.drop_detections=0"});
  const std::string name = fs::path(Recording()).filename().string() + ", ";
  for (const std::string mode : {"off", "geometry"}) {
    const json ate = Evaluate("ate", mode);
    const double rmse = ValueOf(bench, {name + mode, "ate_rmse", "rgbd"});
    EXPECT_NEAR(rmse, 100 * ate["rmse"].get<double>(), 1e-4) << mode;
    EXPECT_NEAR(ValueOf(bench, {name + mode, "ate_std", "rgbd"}), 100 * ate["std"].get<double>(),
                1e-4)
        << mode;
    EXPECT_NEAR(ValueOf(bench, {name + mode, "ate_rmse", "rgbd", "cm", 1}), rmse, 1e-9);
    EXPECT_EQ(ValueOf(bench, {name + mode, "tracked", "rgbd"}), ate["n"].get<double>());
  }
  const double off = ValueOf(bench, {name + "off", "ate_rmse", "rgbd"}),
               mode = ValueOf(bench, {name + "geometry", "ate_rmse", "rgbd"});
  EXPECT_NEAR(ValueOf(bench, {name + "geometry", "ate_rmse_improvement", "rgbd"}),
              100 * (off - mode) / off, 1e-9);
}

TEST_F(BenchDynamic, ComparesWithTheRenderedMasksAndWithTheSceneWithoutPeople) {
  const std::string source = "synth:desk?frames=24&actors=2&seed=3";
  const json bench = Bench({source, "--no-live", "--frames", "20", "--seeds", "2"});
  for (const char* sensor : {"rgbd", "mono"}) {
    const auto value = [&](const std::string& mode, const std::string& metric) {
      return ValueOf(bench, {source + ", " + mode, metric, sensor});
    };
    EXPECT_TRUE(std::isnan(value("off", "mask_iou")));
    EXPECT_TRUE(std::isnan(value("off", "detected_box_iou")));  // no detector was given
    EXPECT_EQ(value("off", "kept_in_true_boxes"), 100);
    EXPECT_GT(value("off", "used_static"), 0);
    EXPECT_LE(value("geometry", "used_static"), 100);
    EXPECT_GT(value("geometry", "true_box_iou"), 20);  // the share of its box that a person fills
    EXPECT_EQ(value("off", "frames"), 20);
  }
  const double alone = ValueOf(bench, {source + ", off", "plain_ate", "rgbd"});
  EXPECT_NEAR(ValueOf(bench, {source + ", off", "limit_2", "rgbd"}),
              std::max(2 * alone, alone + 0.5), 1e-9);
  int runs = 0;
  for (const json& row : bench["rows"]) runs += row["metric"] == "ate_rmse" && row.contains("seed");
  EXPECT_EQ(runs, 12);  // sensors, modes and without people, seeds
}

TEST_F(BenchDynamic, ComparesTheMasksThatRunWrites) {
  const std::string results = folder_ / "masks";
  const ProgramResult run = RunAlidade(
      {"run", Recording(), "--dynamics", "geometry", "--write-masks", "--quiet", "--out", results});
  ASSERT_EQ(run.status, 0) << run.err;
  double sum = 0;
  int frames = 0;
  for (const std::string& line : DataLines(Recording() + "/mask.txt")) {
    const std::string stamp = line.substr(0, line.find(' ')), name = line.substr(stamp.size() + 1);
    const cv::Mat truth = ReadImageGray(Recording() + "/" + name);
    const cv::Mat mask = ReadImageGray(results + "/mask/" + stamp + ".png");
    const int either = cv::countNonZero(truth | mask);
    if (either == 0) continue;
    sum += static_cast<double>(cv::countNonZero(truth & mask)) / either;
    ++frames;
  }
  ASSERT_GT(frames, 0);
  const json bench = Bench({Recording(), "--sensor", "rgbd", "--no-live"});
  const std::string name = fs::path(Recording()).filename().string() + ", geometry";
  EXPECT_NEAR(ValueOf(bench, {name, "mask_iou", "rgbd"}), 100 * sum / frames, 1e-9);
}

TEST_F(BenchDynamic, DrawsPicturesWhereItIsAskedTo) {
  const std::string pictures = folder_ / "pictures";
  Bench({Recording(), "--sensor", "rgbd", "--no-live", "--frames", "8", "--pictures", pictures});
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(pictures))
    names.push_back(entry.path().filename().string());
  EXPECT_EQ(names.size(), 8u);  // four of each mode
  for (const std::string& name : names) EXPECT_EQ(name.substr(name.size() - 4), ".png");
}

TEST_F(BenchDynamic, SaysWhatItCannotDo) {
  const auto refused = [&](std::vector<std::string> words, int status) {
    words.insert(words.begin(), "dynamic");
    const ProgramResult result = RunBench(words);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
  };
  refused({folder_ / "nowhere"}, 3);
  refused({Recording(), "--ablation"}, 2);
  refused({Recording(), "--plain", "a", "--plain", "b"}, 2);
  refused({Recording(), "--sensor", "eye"}, 2);
  refused({Recording(), "--sensor", "stereo"}, 2);
  refused({Recording(), "--set", "nonsense=1"}, 2);
  refused({Recording(), "--detector", folder_ / "nothing.onnx"}, 3);
}

}  // namespace
}  // namespace alidade::bench_dynamic_test
