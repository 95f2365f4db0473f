// `alidade-bench` and its benchmarks of parts: the command line, and what is in a result file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench_result.h"

namespace alidade::bench_parts_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(BenchParts, AResultSaysWhatItIsOf) {
  const json result =
      BenchResult({"features", "--source", "synth:desk?width=320&height=240", "--frames", "4"});
  EXPECT_EQ(result["benchmark"], "features");
  EXPECT_THAT(result["commit"].get<std::string>(),
              testing::MatchesRegex("[0-9a-f]{7,}(-dirty)?|unknown"));
  EXPECT_THAT(result["date"].get<std::string>(),
              testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}"));
  EXPECT_NE(result["machine"]["cpu"], "");
  EXPECT_GT(result["machine"]["cores"], 0);
  const double u = result["u_ms"];
  EXPECT_GT(u, 0);
  for (const char* name : {"extraction, 1 thread", "matching, all against all"}) {
    const json row = RowOf(result, {name, "median", "", "ms"});
    EXPECT_GT(row["value"], 0) << name;
    EXPECT_EQ(row["frames"], 4) << name;
    EXPECT_EQ(row["source"], "synth:desk?width=320&height=240") << name;
    EXPECT_NEAR(ValueOf(result, {name, "median", "", "U"}), row["value"].get<double>() / u, 1e-9)
        << name;
  }
}

TEST(BenchProgram, EachBenchmarkHasItsOwnOptions) {
  const std::string help = RunBench({"--help"}).out;
  for (const char* name : {"frame", "features", "ransac", "ba", "place", "wild", "dynamic",
                           "semidense", "phone", "lasting", "large-map"}) {
    EXPECT_THAT(help, HasSubstr(std::string("  ") + name + " "));
    EXPECT_THAT(RunBench({name, "--help"}).out, HasSubstr("--out")) << name;
  }
  const ProgramResult other = RunBench({"features", "--detector", "x.onnx"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("unknown option --detector of `alidade-bench features`"));
  EXPECT_EQ(RunBench({}).status, 2);
}

TEST(BenchProgram, TheUsersProgramSaysWhereTheBenchmarksAre) {
  const ProgramResult result = RunAlidade({"bench", "wild", "--cases", "hall"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("alidade-bench"));
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
  EXPECT_THAT(RunAlidade({"--help"}).out, testing::Not(HasSubstr("bench")));
}

}  // namespace
}  // namespace alidade::bench_parts_test
