// `alidade-bench wild`: that its rows say what happened. How good that was is for
// docs/benchmarks/index.md.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench_result.h"

namespace alidade::bench_wild_test {
namespace {

using nlohmann::json;

// Of each run of a case, by seed, its figures by metric: NaN where there is none.
std::vector<std::map<std::string, double>> RunsOf(const json& result, const std::string& name) {
  std::vector<std::map<std::string, double>> runs;
  for (const json& row : result["rows"]) {
    if (row["case"] != name) continue;
    const size_t seed = row["seed"];
    if (runs.size() < seed) runs.resize(seed);
    runs[seed - 1][row["metric"]] =
        row["value"].is_number() ? row["value"].get<double>() : std::nan("");
  }
  EXPECT_FALSE(runs.empty()) << name;
  return runs;
}

TEST(BenchWild, HasARunForEachCaseAndSaysThatNothingIsFalse) {
  const TempFolder folder;
  const std::string out = folder / "wild.json";
  const ProgramResult result = RunBench({"wild", "--cases", "desk-small,turn", "--seeds", "1",
                                         "--frames", "24", "--check", "--out", out});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("| case | start |"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n| desk-small | "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("2 runs: 0 false poses, 0 false maps"), std::string::npos);
  EXPECT_EQ(result.err, "");  // progress is for terminals

  const json all = json::parse(ReadText(out), nullptr, false);
  for (auto run : RunsOf(all, "desk-small")) {
    EXPECT_GE(run["start"], 0);
    EXPECT_LE(run["tracked"], 24 - run["start"]);
    EXPECT_GT(run["usable"], 0);
    EXPECT_LT(run["usable"], 10);
    EXPECT_EQ(run["maps"], 1);
    EXPECT_EQ(run["false_poses"], 0);
    EXPECT_LT(run["ate_of_path"], 5);
    EXPECT_TRUE(std::isnan(run["coverage"]));  // not a second of usable motion
  }
  EXPECT_EQ(RowOf(all, {"desk-small", "tracked", "mono", "", 1})["frames"], 24);
  // A turn about the camera's centre has no usable motion and gives no map.
  for (auto run : RunsOf(all, "turn")) {
    EXPECT_EQ(run["map_expected"], 0);
    EXPECT_EQ(run["usable"], -1);
    EXPECT_EQ(run["maps"], 0);
    EXPECT_TRUE(std::isnan(run["coverage"]));
  }
  EXPECT_NE(RowOf(all, {"turn", "tracked", "mono", "", 1})["note"], "");
}

// The plane of a bare table allows other motions nearly as well, straight back above all: two of
// these five began so, and half of their poses were wrong.
TEST(BenchWild, ABareTableIsNotMistakenForAWayStraightBack) {
  const json all = BenchResult({"wild", "--cases", "table", "--seeds", "5", "--frames", "50"});
  const auto runs = RunsOf(all, "table");
  ASSERT_EQ(runs.size(), 5u);
  for (auto run : runs) {
    EXPECT_EQ(run["false_poses"], 0);
    EXPECT_GT(run["tracked"], 40);
    EXPECT_LT(run["ate_of_path"], 3);
  }
}

// At the far end the camera turns before a wall, a few centimetres from keyframe to keyframe: what
// was mapped from so little came out at half its depth, and at half of that again (297 wrong
// poses). And a turn on the spot of 40 degrees through a lens far wider than assumed: where the
// lens was looked for from one start alone, a radial term stood for it, and a map began (122 wrong
// poses).
TEST(BenchWild, TurnsBreakNoScaleAndBeginNoMap) {
  for (const auto& [name, seeds] : {std::pair("hall", "1"), std::pair("turn-wide", "2")}) {
    const json all = BenchResult({"wild", "--cases", name, "--seeds", seeds, "--check"});
    for (auto run : RunsOf(all, name)) {
      EXPECT_EQ(run["false_poses"], 0) << name;
      if (std::string(name) == "hall") {
        // Of 420; 382 when frames that were lost before the second map were not placed in it.
        EXPECT_GT(run["tracked"], 384);
      }
    }
  }
}

// Between two frames the camera turns by up to 25 degrees: where motion alone was believed, one
// seed of three was 28 cm off (2.2 % of its path).
TEST(BenchWild, ThreeFramesASecondBendNothing) {
  const json all = BenchResult({"wild", "--cases", "room-3hz", "--seeds", "3"});
  const auto runs = RunsOf(all, "room-3hz");
  ASSERT_EQ(runs.size(), 3u);
  for (auto run : runs) {
    EXPECT_EQ(run["false_poses"], 0);
    EXPECT_GT(run["tracked"], 40);
    EXPECT_LT(run["ate_of_path"], 1);
  }
}

// Cups that hands move about before a bare wall: two that happened to move alike began a map in
// the last ten frames. And with movers left out nothing was left that stands still, nor was the
// picture looked at.
TEST(BenchWild, AStillCameraMakesNoMapOfWhatMoves) {
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"still-cups", "--seeds", "1"},
        {"still-cup", "--seeds", "2", "--frames", "40", "--set", "dynamics.mode=geometry"}}) {
    std::vector<std::string> all{"wild", "--check", "--cases"};
    all.insert(all.end(), args.begin(), args.end());
    for (auto run : RunsOf(BenchResult(all), args[0])) EXPECT_EQ(run["maps"], 0) << args[0];
  }
}

TEST(BenchWild, KnowsItsCasesAndSettings) {
  const ProgramResult result = RunBench({"wild", "--cases", "desk,still-cap"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("still-cup"), std::string::npos) << result.err;
  EXPECT_EQ(RunBench({"wild", "synth:room"}).status, 2);
  const ProgramResult unknown = RunBench({"wild", "--set", "nonsense=1"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("nonsense"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace alidade::bench_wild_test
