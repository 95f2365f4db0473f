// `alidade bench wild`: that its rows say what happened. How good that was is for
// docs/benchmarks/robustness.md.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"

namespace alidade::bench_wild_test {
namespace {

using nlohmann::json;

TEST(BenchWild, GivesARowForEachCaseAndSaysThatNothingIsFalse) {
  const TempFolder folder;
  const std::string out = folder / "wild.json";
  const ProgramResult result = RunAlidade({"bench", "wild", "--cases", "desk-small,turn", "--seeds",
                                           "1", "--frames", "24", "--check", "--out", out});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("| case | start |"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n| desk-small | "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("2 runs: 0 false poses, 0 false maps"), std::string::npos);
  EXPECT_EQ(result.err, "");  // progress is for terminals

  const json all = json::parse(ReadText(out), nullptr, false);
  ASSERT_EQ(all["cases"].size(), 2u);
  for (const json& run : all["cases"][0]["runs"]) {
    EXPECT_EQ(run["frames"], 24);
    const int start = run["start"], tracked = run["tracked"], usable = run["usable"];
    EXPECT_GE(start, 0);
    EXPECT_LE(tracked, 24 - start);
    EXPECT_GT(usable, 0);
    EXPECT_LT(usable, 10);
    EXPECT_EQ(run["maps"], 1);
    EXPECT_EQ(run["false_poses"], 0);
    EXPECT_LT(run["ate_percent"].get<double>(), 5);
    EXPECT_TRUE(run["coverage"].is_null());  // not a second of usable motion
  }
  // A turn about the camera's centre has no usable motion and gives no map.
  EXPECT_EQ(all["cases"][1]["map_expected"], false);
  for (const json& run : all["cases"][1]["runs"]) {
    EXPECT_EQ(run["usable"], -1);
    EXPECT_EQ(run["maps"], 0);
    EXPECT_TRUE(run["coverage"].is_null());
    EXPECT_NE(run["reason"], "");
  }
}

// The plane of a bare table allows other motions nearly as well, straight back above all: two of
// these five began so, and half of their poses were wrong.
TEST(BenchWild, ABareTableIsNotMistakenForAWayStraightBack) {
  const TempFolder folder;
  const std::string out = folder / "wild.json";
  const ProgramResult result = RunAlidade(
      {"bench", "wild", "--cases", "table", "--seeds", "5", "--frames", "50", "--out", out});
  EXPECT_EQ(result.status, 0) << result.err;
  const json all = json::parse(ReadText(out), nullptr, false);
  ASSERT_EQ(all["cases"][0]["runs"].size(), 5u);
  for (const json& run : all["cases"][0]["runs"]) {
    EXPECT_EQ(run["false_poses"], 0) << run;
    EXPECT_GT(run["tracked"], 40) << run;
    EXPECT_LT(run["ate_percent"].get<double>(), 3) << run;
  }
}

// At the far end the camera turns before a wall, a few centimetres from keyframe to keyframe: what
// was mapped from so little came out at half its depth, and at half of that again (297 wrong
// poses). And a turn on the spot of 40 degrees through a lens far wider than assumed: where the
// lens was looked for from one start alone, a radial term stood for it, and a map began (122 wrong
// poses).
TEST(BenchWild, TurnsBreakNoScaleAndBeginNoMap) {
  const TempFolder folder;
  const std::string out = folder / "wild.json";
  for (const auto& [name, seeds] : {std::pair("hall", "1"), std::pair("turn-wide", "2")}) {
    const ProgramResult result =
        RunAlidade({"bench", "wild", "--cases", name, "--seeds", seeds, "--check", "--out", out});
    EXPECT_EQ(result.status, 0) << result.err;
    const json all = json::parse(ReadText(out), nullptr, false);
    for (const json& run : all["cases"][0]["runs"]) {
      EXPECT_EQ(run["false_poses"], 0) << run;
      if (std::string(name) == "hall") {
        // Of 420; 382 when frames that were lost before the second map were not placed in it.
        EXPECT_GT(run["tracked"], 388) << run;
      }
    }
  }
}

// Between two frames the camera turns by up to 25 degrees: where motion alone was believed, one
// seed of three was 28 cm off (2.2 % of its path).
TEST(BenchWild, ThreeFramesASecondBendNothing) {
  const TempFolder folder;
  const std::string out = folder / "wild.json";
  const ProgramResult result =
      RunAlidade({"bench", "wild", "--cases", "room-3hz", "--seeds", "3", "--out", out});
  EXPECT_EQ(result.status, 0) << result.err;
  const json all = json::parse(ReadText(out), nullptr, false);
  ASSERT_EQ(all["cases"][0]["runs"].size(), 3u);
  for (const json& run : all["cases"][0]["runs"]) {
    EXPECT_EQ(run["false_poses"], 0) << run;
    EXPECT_GT(run["tracked"], 40) << run;
    EXPECT_LT(run["ate_percent"].get<double>(), 1) << run;
  }
}

// Cups that hands move about before a bare wall: two that happened to move alike began a map in
// the last ten frames. And with movers left out nothing was left that stands still, nor was the
// picture looked at.
TEST(BenchWild, AStillCameraMakesNoMapOfWhatMoves) {
  const TempFolder folder;
  const std::string out = folder / "wild.json";
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"still-cups", "--seeds", "1"},
        {"still-cup", "--seeds", "2", "--frames", "40", "--set", "dynamics.mode=geometry"}}) {
    std::vector<std::string> all{"bench", "wild", "--check", "--out", out, "--cases"};
    all.insert(all.end(), args.begin(), args.end());
    const ProgramResult result = RunAlidade(all);
    EXPECT_EQ(result.status, 0) << result.err;
    const json answer = json::parse(ReadText(out), nullptr, false);
    for (const json& run : answer["cases"][0]["runs"]) EXPECT_EQ(run["maps"], 0) << run;
  }
}

TEST(BenchWild, KnowsItsCasesAndSettings) {
  const ProgramResult result = RunAlidade({"bench", "wild", "--cases", "desk,still-cap"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("still-cup"), std::string::npos) << result.err;
  EXPECT_EQ(RunAlidade({"bench", "wild", "synth:room"}).status, 2);
  const ProgramResult unknown = RunAlidade({"bench", "wild", "--set", "nonsense=1"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("nonsense"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace alidade::bench_wild_test
