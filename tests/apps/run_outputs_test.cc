// What `alidade run` leaves behind, and where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "alidade/io/files/trajectory_file.h"
#include "support/program.h"
#include "support/sliding_recording.h"
#include "support/small_disk.h"

namespace alidade::run_outputs_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::set<std::string> NamesIn(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

class RunOutputs : public testing::Test {
 protected:
  RunOutputs() { WriteSlidingTum(recording_); }

  ProgramResult Run(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"run", recording_.path(), "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunAlidade(arguments);
  }
  nlohmann::json Stats(const std::string& out) {
    return nlohmann::json::parse(ReadText(out + "/stats.json"));
  }

  SlidingRecording truth_;
  TempFolder recording_, results_;
};

TEST_F(RunOutputs, TrajectoryIsTheCamerasWithStampsLetterByLetter) {
  const std::string out = results_ / "out";
  ASSERT_EQ(Run(out).status, 0);
  const Trajectory trajectory = ReadTrajectory(out + "/trajectory.txt");
  ASSERT_EQ(trajectory.size(), static_cast<size_t>(truth_.frames));
  std::istringstream lines(ReadText(out + "/trajectory.txt"));
  for (int i = 0; i < truth_.frames; ++i) {
    const Se3& T = trajectory[static_cast<size_t>(i)].T_world_camera;
    // A pixel is 8 mm at the wall, and from a wall alone turning and sliding look alike.
    EXPECT_LT((T.t - Eigen::Vector3d(i * truth_.metres(), 0, 0)).norm(), 0.010) << i;
    std::string line;
    do {
      std::getline(lines, line);
    } while (line[0] == '#');
    EXPECT_EQ(line.substr(0, line.find(' ')), SlidingStamp(i));
  }
}

TEST_F(RunOutputs, StatsCountThePartThatWasPlayed) {
  const std::string out = results_ / "out";
  ASSERT_EQ(Run(out, {"--first", "2", "--last", "9"}).status, 0);
  const nlohmann::json stats = Stats(out);
  for (const char* stage :
       {"frame", "extract", "track", "map", "loop", "detect", "dynamics", "semidense"}) {
    EXPECT_TRUE(stats["ms"].contains(stage)) << stage;
  }
  EXPECT_EQ(stats["ms"]["frame"]["count"], 8);
  EXPECT_EQ(stats["source"], recording_.path());
  EXPECT_EQ(stats["sensor"], "rgbd");
  EXPECT_EQ(stats["frames"], 8);
  EXPECT_EQ(stats["tracked"], 8);
  EXPECT_EQ(stats["coverage"], 1.0);
  EXPECT_EQ(stats["initialized_at"], 2);  // numbers are the recording's
  EXPECT_EQ(stats["dropped_frames"], 0);
  EXPECT_GT(stats["cpu_s"], 0.0);
  EXPECT_GT(stats["peak_mb"], 5.0);
}

// A table of readings at rest; the gyroscope's y axis may be dead.
std::string ImuTable(bool dead) {
  std::string text = "t [s],wx [rad/s],wy,wz,ax [m/s^2],ay,az\n";
  for (int i = 0; i < 2000; ++i) {
    const double t = std::stod(SlidingStamp(0)) - 2 + 0.005 * i;
    text += std::to_string(t) + "," + std::to_string(std::sin(t)) + "," +
            (dead ? "0.01" : std::to_string(0.01 * std::sin(3 * t))) + "," +
            std::to_string(std::cos(t)) + "," + std::to_string(0.2 * std::sin(t)) + "," +
            std::to_string(9.8 + 0.01 * std::sin(7 * t)) + "," + std::to_string(0.3 * std::cos(t)) +
            "\n";
  }
  return text;
}

TEST_F(RunOutputs, StatsTellOfInertialReadings) {
  ASSERT_EQ(Run(results_ / "none").status, 0);
  nlohmann::json stats = Stats(results_ / "none");
  EXPECT_TRUE(stats["imu"].is_null() && stats["gravity"].is_null());
  EXPECT_EQ(stats["scale"], (nlohmann::json{{"known", true}, {"sigma", nullptr}}));  // depth
  EXPECT_TRUE(stats["reading"]["imu"].is_null());
  // A broken sensor, by an option; then the same beside the images, turned off.
  const std::string table = recording_.Write("broken.csv", ImuTable(true));
  ASSERT_EQ(Run(results_ / "broken", {"--imu", table}).status, 0);
  recording_.Write("imu.csv", ImuTable(false));
  ASSERT_EQ(Run(results_ / "off", {"--imu", "off"}).status, 0);
  stats = Stats(results_ / "broken");
  EXPECT_TRUE(stats["imu"].is_null());
  EXPECT_THAT(stats["warnings"].dump(), HasSubstr("y axis is dead"));
  EXPECT_EQ(stats["reading"]["imu"], table);
  EXPECT_EQ(Stats(results_ / "off")["reading"]["imu"], "off");
  EXPECT_TRUE(Stats(results_ / "off")["imu"].is_null());
  for (const std::string name :
       {"trajectory.txt", "keyframes.txt", "landmarks.ply", "map.alidade"}) {
    EXPECT_EQ(ReadText(results_ / ("broken/" + name)), ReadText(results_ / ("none/" + name)));
    EXPECT_EQ(ReadText(results_ / ("off/" + name)), ReadText(results_ / ("none/" + name)));
  }
  ASSERT_EQ(Run(results_ / "with").status, 0);
  stats = Stats(results_ / "with");
  ASSERT_FALSE(stats["imu"].is_null());
  EXPECT_NEAR(stats["imu"]["rate"], 200, 0.1);
  for (const char* key : {"samples", "time_offset", "time_offset_sigma", "gyro_bias", "accel_bias"})
    EXPECT_TRUE(stats["imu"].contains(key)) << key;
  EXPECT_EQ(Run(results_ / "typo", {"--imu", results_ / "none.csv"}).status, 3);
}

TEST_F(RunOutputs, ReportNeedsNothingElse) {
  const std::string out = results_ / "out";
  ASSERT_EQ(Run(out).status, 0);
  const std::string report = ReadText(out + "/report.html");
  EXPECT_THAT(report, HasSubstr("<svg"));
  EXPECT_THAT(report, HasSubstr("class=\"path\""));
  for (const char* outside : {"http:", "https:", "href=", "@import", "url(", "fetch("})
    EXPECT_EQ(report.find(outside), std::string::npos) << outside;
  for (size_t at = 0; (at = report.find("src=", at)) != std::string::npos; ++at)
    EXPECT_EQ(report.compare(at, 12, "src=\"data:im"), 0) << report.substr(at, 40);
  EXPECT_LT(report.size(), 3u << 20);
}

TEST_F(RunOutputs, AnotherFolderIsLeftAlone) {
  const std::string out = results_.Folder("mine");
  results_.Write("mine/thesis.txt", "years of work");
  const ProgramResult result = Run(out);
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr(out));
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
  EXPECT_EQ(NamesIn(out), (std::set<std::string>{"thesis.txt"}));
  // A stats.json is not ours because of its name.
  results_.Write("mine/stats.json", "{\"players\": 11}");
  EXPECT_EQ(Run(out).status, 3);
  EXPECT_EQ(ReadText(out + "/stats.json"), "{\"players\": 11}");
}

TEST_F(RunOutputs, EarlierRunIsReplacedAndOnlyOurFilesGo) {
  const std::string out = results_ / "out";
  ASSERT_EQ(Run(out).status, 0);
  results_.Write("out/notes.txt", "mine");
  results_.Write("out/groundtruth.txt", "mine as well");
  results_.Write("out/trajectory.txt.tmp123-4", "left by a run that was killed");
  ASSERT_EQ(Run(out, {"--last", "5", "--overwrite"}).status, 0);
  EXPECT_EQ(Stats(out)["frames"], 6);
  const std::set<std::string> names = NamesIn(out);
  EXPECT_TRUE(names.count("notes.txt"));
  EXPECT_TRUE(names.count("trajectory.txt"));
  EXPECT_TRUE(names.count("groundtruth.txt"));
  EXPECT_FALSE(names.count("trajectory.txt.tmp123-4"));
}

TEST_F(RunOutputs, BadSourceLeavesNoFolder) {
  const std::string out = results_ / "out";
  EXPECT_EQ(RunAlidade({"run", results_ / "nothing-here", "--out", out}).status, 3);
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(RunOutputs, FullDiskLeavesNoPartOfAFile) {
  // Too small to begin with; room for the trajectory but not for all; for nearly all.
  for (const int kilobytes : {16, 72, 96}) {
    const std::string folder = results_.Folder("disk" + std::to_string(kilobytes));
    const SmallDisk disk(folder, kilobytes);
    if (!disk.mounted()) GTEST_SKIP() << "mounting is not permitted here";
    const std::string out = folder + "/out";
    const ProgramResult result = Run(out);
    EXPECT_EQ(result.status, 3) << kilobytes;
    EXPECT_THAT(result.err, HasSubstr("No space left on device"));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    if (!fs::exists(out)) continue;
    const std::set<std::string> names = NamesIn(out);
    EXPECT_TRUE(names.count("stats.json")) << "what stays can be written over";
    for (const std::string& name : names) EXPECT_THAT(name, Not(HasSubstr("tmp")));
    EXPECT_EQ(ReadTrajectory(out + "/trajectory.txt").size(), static_cast<size_t>(truth_.frames));
  }
}

}  // namespace
}  // namespace alidade::run_outputs_test
