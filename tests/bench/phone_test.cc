// `alidade-bench phone`: that its figures say what was run. How fast that was is for
// docs/benchmarks/index.md.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench_result.h"

namespace alidade::bench_phone_test {
namespace {

using nlohmann::json;

TEST(BenchPhone, HasTheFiguresOfThePaperWithErrorAndCoverageBesideThem) {
  const std::string source = "synth:desk?frames=40&width=480&height=360";
  const json bench = BenchResult({"phone", source});
  std::vector<std::string> names;
  bool wasm = false, ransac = false;
  for (const json& row : bench["rows"]) {
    const std::string name = row["case"];
    ransac |= name == source + ", RANSAC of H and F, serial";
    wasm |= name.rfind(source + ", WASM", 0) == 0;
    if (row["metric"] == "coverage") names.push_back(name);
  }
  EXPECT_TRUE(ransac);
  // Four steps of parameters and two schedules of two of them at least; WASM where it was built.
  EXPECT_GE(names.size(), wasm ? 8u : 6u);
  const std::string serial = source + ", full size, 1000 features";
  EXPECT_EQ(names[0], serial);
  for (const std::string& name : names) {
    const auto value = [&](const std::string& metric) {
      return ValueOf(bench, {name, metric, "mono"});
    };
    for (const char* metric : {"extract", "track", "frame", "frame_mean"})
      EXPECT_GT(value(metric), 0) << name;
    if (name.find("live") != std::string::npos) continue;  // a busy machine leaves out frames
    EXPECT_GE(value("frame"), value("extract")) << name;
    EXPECT_LT(value("ate_rmse"), 5) << name;
    EXPECT_GT(value("coverage"), 80) << name;
    EXPECT_GE(value("keyframes"), 2) << name;
    // Loops on more threads change no pose: the error is the same to the last digit.
    if (name.rfind(source + ", full size, loops on", 0) != 0) continue;
    EXPECT_EQ(value("ate_rmse"), ValueOf(bench, {serial, "ate_rmse", "mono"}));
  }
  const std::string whole = source + ", whole frame, ";
  EXPECT_EQ(ValueOf(bench, {whole + "before", "paper", "mono"}), 1134);
  EXPECT_EQ(ValueOf(bench, {whole + "after the parameters", "paper", "mono"}), 513);
  EXPECT_EQ(ValueOf(bench, {whole + "and with threads", "paper", "mono"}), 175);
  EXPECT_EQ(ValueOf(bench, {whole + "before", "native_speedup", "mono"}), 1);
}

TEST(BenchPhone, RefusesWhatIsNoRecording) {
  const ProgramResult result = RunBench({"phone", "no-such-folder"});
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
}

}  // namespace
}  // namespace alidade::bench_phone_test
