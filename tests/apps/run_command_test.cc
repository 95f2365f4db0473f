// `alidade run` from end to end: what it leaves, that it leaves the same twice, and how near to the
// truth it comes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/rendered.h"

namespace alidade::run_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class RunCommand : public testing::Test {
 protected:
  // Runs into a folder of its own, and returns it.
  std::string Run(const std::string& source, std::vector<std::string> options = {}) {
    const std::string out = folder_ / ("out" + std::to_string(runs_++));
    std::vector<std::string> arguments = {"run", source, "--out", out, "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return out;
  }
  static json Stats(const std::string& out) {
    return json::parse(ReadText(out + "/stats.json"), nullptr, false);
  }
  static json Ate(const std::string& truth, const std::string& out, const std::string& align) {
    const ProgramResult result =
        RunAlidade({"evaluate", "ate", truth, out + "/trajectory.txt", "--align", align, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false);
  }
  static double Rmse(const std::string& truth, const std::string& out, const std::string& align) {
    return Ate(truth, out, align).value("rmse", 1e9);
  }

  TempFolder folder_;
  int runs_ = 0;
};

std::string Room() { return Rendered({"room", "--frames", "60", "--seed", "5"}); }

TEST_F(RunCommand, LeavesWhatTheDocumentsSay) {
  const std::string out = Run(Room());
  for (const char* name :
       {"trajectory.txt", "trajectory_live.txt", "keyframes.txt", "landmarks.ply", "stats.json"}) {
    EXPECT_TRUE(fs::exists(out + "/" + name)) << name;
  }
  const json stats = Stats(out);
  for (const char* name :
       {"version", "source",   "sensor",         "settings",       "frames",
        "tracked", "coverage", "initialized_at", "lost_spans",     "relocalizations",
        "loops",   "maps",     "keyframes",      "landmarks",      "ms",
        "cpu_s",   "wall_s",   "peak_mb",        "dropped_frames", "warnings"}) {
    EXPECT_TRUE(stats.contains(name)) << name;
  }
  for (const char* name : {"frame", "extract", "track", "map"}) {
    EXPECT_TRUE(stats["ms"][name].is_object()) << name;
  }
  EXPECT_EQ(stats["frames"], 60);
  EXPECT_EQ(stats["sensor"], "rgbd");
  EXPECT_EQ(DataLines(out + "/keyframes.txt").size(), stats["keyframes"].get<size_t>());
}

TEST_F(RunCommand, CountsWhatSemiDenseMappingDid) {
  EXPECT_TRUE(Stats(Run(Room()))["semidense"].is_null());
  const json stats = Stats(Run(Room(), {"--semidense"}));
  const json& counts = stats["semidense"];
  ASSERT_TRUE(counts.is_object());
  EXPECT_GE(counts["keyframes"], stats["keyframes"]);
  EXPECT_GT(counts["pixels"], 0);
  EXPECT_LT(counts["pixels"], 640 * 480);
  EXPECT_GT(counts["searches"], counts["pixels"]);  // several keyframes for each
  EXPECT_GT(counts["mean_search"], 1);
  EXPECT_LE(counts["most_behind"], 1);  // inline: none waits
}

TEST_F(RunCommand, CopiesTimeStampsLetterByLetter) {
  const std::string room = Room();
  const std::string out = Run(room);
  std::vector<std::string> given, written;
  for (const std::string& line : DataLines(room + "/rgb.txt")) {
    given.push_back(line.substr(0, line.find(' ')));
  }
  for (const std::string& line : DataLines(out + "/trajectory.txt")) {
    written.push_back(line.substr(0, line.find(' ')));
  }
  EXPECT_EQ(written, given);
}

TEST_F(RunCommand, GivesTheSameBytesTwiceAndWithAnyNumberOfThreads) {
  for (const char* sensor : {"rgbd", "mono"}) {
    const std::string one = Run(Room(), {"--sensor", sensor, "--threads", "1"});
    for (const char* threads : {"2", "1", "3"}) {
      const std::string other = Run(Room(), {"--sensor", sensor, "--threads", threads});
      for (const char* name : {"trajectory.txt", "trajectory_live.txt", "keyframes.txt",
                               "landmarks.ply", "map.alidade"}) {
        EXPECT_EQ(ReadText(one + "/" + name), ReadText(other + "/" + name))
            << name << " of " << sensor << " with " << threads << " threads";
      }
    }
  }
}

TEST_F(RunCommand, PlaysThePartThatWasAskedFor) {
  const std::string out = Run(Room(), {"--first", "10", "--last", "29"});
  const json stats = Stats(out);
  EXPECT_EQ(stats["frames"], 20);
  EXPECT_EQ(stats["initialized_at"], 10);
  EXPECT_EQ(Ate(Room() + "/groundtruth.txt", out, "se3")["coverage"], 1);
}

TEST_F(RunCommand, RunsAgainIntoItsOwnFolder) {
  const std::string out = Run(Room(), {"--last", "9"});
  EXPECT_EQ(RunAlidade({"run", Room(), "--last", "19", "--out", out, "--quiet"}).status, 0);
  EXPECT_EQ(Stats(out)["frames"], 20);
}

TEST_F(RunCommand, RgbdInARenderedRoomIsWithinACentimetre) {
  const std::string room = Rendered({"room", "--frames", "150", "--seed", "7"});
  for (const char* schedule : {"inline", "threaded"}) {
    const std::string out = Run(room, {"--schedule", schedule});
    EXPECT_EQ(Stats(out)["coverage"], 1) << schedule;
    EXPECT_LT(Rmse(room + "/groundtruth.txt", out, "se3"), 0.010) << schedule;
  }
}

TEST_F(RunCommand, StereoInARenderedRoomIsWithinTwelveMillimetres) {
  const std::string room =
      Rendered({"room", "--frames", "60", "--stereo", "--format", "euroc", "--seed", "7"});
  const std::string out = Run(room);
  EXPECT_EQ(Stats(out)["sensor"], "stereo");
  EXPECT_EQ(Stats(out)["coverage"], 1);
  EXPECT_LT(Rmse(room, out, "se3"), 0.012);
}

// On real recordings, under ALIDADE_DATA. The goals are the issue's; inline, so that the figures
// are the same each time.
class RealRecording : public RunCommand {
 protected:
  void SetUp() override {
    if (DataFolder().empty()) GTEST_SKIP() << "ALIDADE_DATA is not set";
  }
  static std::string Recording(const std::string& name) { return DataFolder() + "/" + name; }
};

TEST_F(RealRecording, KitchenWithDepth) {
  const std::string kitchen = Recording("kitchen");
  const std::string out = Run(kitchen);
  EXPECT_EQ(Stats(out)["tracked"], 600);
  EXPECT_LE(Rmse(kitchen, out, "se3"), 0.045);
}

TEST_F(RealRecording, KitchenWithOneCamera) {
  const std::string kitchen = Recording("kitchen");
  const std::string out = Run(kitchen, {"--sensor", "mono"});
  const json stats = Stats(out);
  EXPECT_LE(stats["initialized_at"], 35);
  EXPECT_EQ(stats["tracked"].get<int>() + stats["initialized_at"].get<int>(), 600);
  EXPECT_LE(Rmse(kitchen, out, "sim3"), 0.038);  // its truth is good to 3-4 cm; 3.6 cm measured
}

TEST_F(RealRecording, FreiburgTurningWithDepth) {
  const std::string turning = Recording("fr1_rpy");
  const std::string out = Run(turning);
  EXPECT_EQ(Stats(out)["coverage"], 1);
  EXPECT_LE(Rmse(turning, out, "se3"), 0.022);
}

TEST_F(RealRecording, EurocStandingStill) {
  const std::string out = Run(Recording("euroc_micro"));
  EXPECT_EQ(Stats(out)["tracked"], 24);
  const auto lines = DataLines(out + "/trajectory.txt");
  ASSERT_EQ(lines.size(), 24u);
  for (const std::string& line : lines) {
    double v[8] = {};
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf %lf %lf %lf %lf %lf %lf %lf", &v[0], &v[1], &v[2],
                          &v[3], &v[4], &v[5], &v[6], &v[7]),
              8);
    EXPECT_LT(std::hypot(v[1], v[2], v[3]), 0.010) << line;
    const double degrees =
        2 * std::asin(std::min(1.0, std::hypot(v[4], v[5], v[6]))) * 180 / 3.14159265358979;
    EXPECT_LT(degrees, 0.3) << line;
  }
}

TEST_F(RealRecording, PhoneProfileKeepsUpWithTheDesktopsCoverage) {
  const std::string kitchen = Recording("kitchen");
  const std::string out = Run(kitchen, {"--sensor", "mono", "--profile", "phone"});
  const json stats = Stats(out);
  EXPECT_EQ(stats["tracked"].get<int>() + stats["initialized_at"].get<int>(), 600);
  EXPECT_LE(Rmse(kitchen, out, "sim3"), 1.3 * 0.034);
}

}  // namespace
}  // namespace alidade::run_command_test
