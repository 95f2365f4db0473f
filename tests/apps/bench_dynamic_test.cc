// `alidade bench dynamic`: that its figures are those the other commands give, and that it says
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
#include "support/program.h"
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

  json Bench(std::vector<std::string> words) {
    words.insert(words.begin(), {"bench", "dynamic"});
    words.insert(words.end(), {"--out", out_});
    const ProgramResult result = RunAlidade(words);
    EXPECT_EQ(result.status, 0) << result.err;
    const json all = json::parse(ReadText(out_), nullptr, false);
    EXPECT_EQ(all["benches"].size(), 1u);
    return all["benches"][0];
  }

  // The table whose name begins so; there must be one.
  static json TableOf(const json& bench, const std::string& start) {
    json found;
    for (const json& table : bench["tables"]) {
      if (table["name"].get<std::string>().rfind(start, 0) != 0) continue;
      EXPECT_TRUE(found.is_null()) << start;
      found = table;
    }
    EXPECT_FALSE(found.is_null()) << start;
    return found;
  }

  // NaN where there is nothing to tell. The row must be there once.
  static double Figure(const json& table, const std::string& label, const std::string& column) {
    const auto index = [&](const char* list, const std::string& name) {
      const auto words = table[list].get<std::vector<std::string>>();
      EXPECT_EQ(std::count(words.begin(), words.end(), name), 1) << name;
      return static_cast<size_t>(std::find(words.begin(), words.end(), name) - words.begin());
    };
    const json& figure = table["rows"][index("labels", label)][index("columns", column)];
    return figure.is_number() ? figure.get<double>() : std::nan("");
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
  std::string out_ = folder_ / "bench.json";
};

TEST_F(BenchDynamic, GivesTheErrorsThatEvaluateGives) {
  const json bench =
      Bench({Recording(), "--sensor", "rgbd", "--no-live", "--set", "dynamics.drop_detections=0"});
  const std::string label = fs::path(Recording()).filename().string() + " rgbd";
  for (const std::string mode : {"off", "geometry"}) {
    const json ate = Evaluate("ate", mode);
    const json table = TableOf(bench, "1. absolute");
    EXPECT_NEAR(Figure(table, label, mode), 100 * ate["rmse"].get<double>(), 1e-4) << mode;
    EXPECT_NEAR(Figure(table, label, mode + " Std"), 100 * ate["std"].get<double>(), 1e-4) << mode;
    const json run = TableOf(bench, "each run");
    EXPECT_NEAR(Figure(run, label + " " + mode, "ATE cm"), Figure(table, label, mode), 1e-9);
    EXPECT_EQ(Figure(run, label + " " + mode, "tracked"), ate["n"].get<double>());
  }
  const json table = TableOf(bench, "1. absolute");
  const double off = Figure(table, label, "off"), mode = Figure(table, label, "geometry");
  EXPECT_NEAR(Figure(table, label, "geometry eta %"), 100 * (off - mode) / off, 1e-9);
}

TEST_F(BenchDynamic, ComparesWithTheRenderedMasksAndWithTheSceneWithoutPeople) {
  const std::string source = "synth:desk?frames=24&actors=2&seed=3";
  const json bench = Bench({source, "--no-live", "--frames", "20", "--seeds", "2"});
  const json masks = TableOf(bench, "masks of movers");
  for (const char* sensor : {" rgbd", " mono"}) {
    const std::string off = source + sensor + " off", geometry = source + sensor + " geometry";
    EXPECT_TRUE(std::isnan(Figure(masks, off, "IoU")));
    EXPECT_TRUE(std::isnan(Figure(masks, off, "det. box")));  // no detector was given
    EXPECT_EQ(Figure(masks, off, "kept true"), 100);
    EXPECT_GT(Figure(masks, off, "static"), 0);
    EXPECT_LE(Figure(masks, geometry, "static"), 100);
    EXPECT_GT(Figure(masks, geometry, "true box"), 20);  // a person fills so much of its box
    EXPECT_EQ(Figure(TableOf(bench, "4. coverage"), off, "frames"), 20);
  }
  const json plain = TableOf(bench, "against the same frames");
  const double alone = Figure(plain, source + " rgbd off", "plain");
  EXPECT_NEAR(Figure(plain, source + " rgbd off", "x 2"), std::max(2 * alone, alone + 0.5), 1e-9);
  EXPECT_EQ(TableOf(bench, "each run")["rows"].size(),
            12u);  // sensors, modes and without people, seeds
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
  const std::string label = fs::path(Recording()).filename().string() + " rgbd geometry";
  EXPECT_NEAR(Figure(TableOf(bench, "masks of movers"), label, "IoU"), 100 * sum / frames, 1e-9);
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
    words.insert(words.begin(), {"bench", "dynamic"});
    const ProgramResult result = RunAlidade(words);
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
