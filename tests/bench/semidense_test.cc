// `alidade-bench semidense`: that it measures what it says it measures; how long that takes is
// nobody's to assert.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench_result.h"

namespace alidade::bench_semidense_test {
namespace {

using nlohmann::json;

TEST(BenchSemiDense, HasACaseForEachStepAndEachNumberOfKeyframes) {
  const std::string source = "synth:desk?width=320&height=240&fps=20";
  const json bench = BenchResult({"semidense", source, "--frames", "30"});
  const auto value = [&](const std::string& label, const std::string& metric) {
    const char* sensor = label.rfind("RGB-D", 0) == 0 ? "rgbd" : "mono";
    return ValueOf(bench, {source + ", " + label, metric, sensor});
  };
  for (const char* label :
       {"all steps, N = 7", "without fusion (2)", "without smoothing (3)", "without the check (4)",
        "N = 3", "N = 5", "N = 10", "phone profile", "RGB-D map", "RGB-D map, sensor's"}) {
    const double median = value(label, "error_median");
    EXPECT_GT(median, 0) << label;
    EXPECT_LT(median, 50) << label;
  }
  // What is known whatever the figures are: each step costs or removes something.
  const auto default_value = [&](const char* metric) { return value("all steps, N = 7", metric); };
  EXPECT_GT(value("without the check (4)", "density"), default_value("density"));
  EXPECT_GT(value("N = 10", "searches"), value("N = 3", "searches"));
  EXPECT_EQ(value("RGB-D map, sensor's", "searches"), 0);
  EXPECT_LE(default_value("density"), 100);
  EXPECT_GT(default_value("pixels"), 0);
  EXPECT_GT(default_value("memory"), 0.1);
  EXPECT_LT(default_value("pixels"), 320 * 240);
  for (const char* label : {"round 1", "round 2", "round 3", "median"}) {
    EXPECT_GT(value(std::string("live, ") + label, "ratio"), 0) << label;
    EXPECT_GE(value(std::string("live, ") + label, "most_waiting"), 0) << label;
  }
  // Exact truth: no second set of pixels.
  for (const json& row : bench["rows"]) EXPECT_NE(row["metric"], "error_median_everywhere");
}

TEST(BenchSemiDense, RefusesWhatIsNoRecording) {
  const TempFolder folder;
  const ProgramResult nothing = RunBench({"semidense", folder / "nowhere"});
  EXPECT_EQ(nothing.status, 3);
  EXPECT_EQ(LineCount(nothing.err), 1) << nothing.err;
}

}  // namespace
}  // namespace alidade::bench_semidense_test
