// `alidade batch`: many recordings, of which some fail; gone on with; held against an earlier one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "bags/bag_bytes.h"
#include "bags/message_bytes.h"
#include "support/program.h"
#include "support/rendered.h"
#include "support/sliding_recording.h"

namespace alidade::batch_command_test {
namespace {

using testing::HasSubstr;

const std::string kRoom = "synth:room?width=320&height=240&frames=";

ProgramResult Batch(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "batch");
  return RunAlidade(arguments);
}

int Lines(const std::string& text, const std::string& with) {
  int count = 0;
  for (size_t at = 0; (at = text.find(with, at)) != std::string::npos; at += with.size()) ++count;
  return count;
}

TEST(BatchCommand, RunsAllCountsFailuresAndGoesOn) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", out = folder / "out";
  WriteLines(list, {"# a comment", kRoom + "25 --out a --sensor rgbd", folder / "nowhere --out b",
                    kRoom + "20&seed=2 --out c --sensor rgbd"});
  const ProgramResult first = Batch({list, "--out", out, "--jobs", "2"});
  EXPECT_EQ(first.status, 1) << first.err;
  EXPECT_THAT(first.out, HasSubstr("3 recordings, 1 failed"));
  EXPECT_THAT(first.out, HasSubstr("nowhere"));  // why
  for (const char* file :
       {"/a/trajectory.txt", "/c/report.html", "/log/b.txt", "/batch.md", "/compare.html"})
    EXPECT_TRUE(std::filesystem::exists(out + file)) << file;
  const auto json = nlohmann::json::parse(ReadText(out + "/batch.json"));
  ASSERT_EQ(json["recordings"].size(), 3u);
  EXPECT_EQ(json["recordings"][0]["state"], "ok");
  EXPECT_EQ(json["recordings"][1]["state"], "failed");
  // The same figures as the parts have.
  const ProgramResult ate =
      RunAlidade({"evaluate", "ate", out + "/a/groundtruth.txt", out + "/a", "--json"});
  EXPECT_EQ(json["recordings"][0]["ate"], nlohmann::json::parse(ate.out)["rmse"]);
  const auto stats = nlohmann::json::parse(ReadText(out + "/a/stats.json"));
  EXPECT_EQ(json["recordings"][0]["cpu_s"], stats["cpu_s"]);
  EXPECT_EQ(json["recordings"][0]["ms"], stats["ms"]["frame"]["median"]);

  // Again: what is done is not done anew, what failed is tried once more.
  const ProgramResult second = Batch({list, "--out", out});
  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.out, HasSubstr("2 of 3 recordings are done already"));
  const std::string diary = ReadText(out + "/batch.log");
  EXPECT_EQ(Lines(diary, " begun a\n"), 1);
  EXPECT_EQ(Lines(diary, " begun b\n"), 2);

  // Other settings are another run; other threads are not.
  WriteLines(list, {kRoom + "25 --out a --sensor rgbd --threads 1",
                    kRoom + "20&seed=2 --out c --sensor rgbd --seed 5"});
  EXPECT_EQ(Batch({list, "--out", out}).status, 0);
  EXPECT_EQ(Lines(ReadText(out + "/batch.log"), " begun a\n"), 1);
  EXPECT_EQ(Lines(ReadText(out + "/batch.log"), " begun c\n"), 2);
}

// A recording along a wall as a ROS bag, with its calibration beside it.
void WriteBag(const std::string& folder, const SlidingRecording& options) {
  const TempFolder pictures;
  WriteSlidingTum(pictures, options);
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < options.frames; ++i) {
    const std::string name = SlidingStamp(i) + ".png";
    const int64_t time = std::llround(1e9 * std::stod(SlidingStamp(i)));
    for (const bool depth : {false, true}) {
      const std::string format = depth ? "16UC1; compressedDepth png" : "png";
      messages.push_back(
          {depth ? "/depth/compressedDepth" : "/cam/compressed", "sensor_msgs/CompressedImage",
           time,
           CompressedMessage({true}, time, "camera", format,
                             (depth ? std::string(12, '\0') : "") +
                                 ReadText(pictures / (depth ? "depth/" : "rgb/") + name))});
    }
  }
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/w.mcap", std::ios::binary) << McapBytes({"zstd"}, false).Of(messages);
  std::ofstream(folder + "/camera.yaml") << ReadText(pictures / "camera.yaml");
}

TEST(BatchCommand, ARecordingOrCalibrationThatWasReplacedIsRunAgain) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", out = folder / "out", bags = folder / "bags";
  WriteBag(bags, {});
  WriteLines(list, {bags + "/w.mcap?image=/cam/compressed&depth=/depth/compressedDepth"});
  int begun = 0;
  const auto expect_begun = [&](int more) {
    const ProgramResult result = Batch({list, "--out", out});
    EXPECT_EQ(result.status, 0) << result.out << result.err;
    begun += more;
    EXPECT_EQ(Lines(ReadText(out + "/batch.log"), " begun w\n"), begun) << result.out;
  };
  expect_begun(1);
  expect_begun(0);
  WriteBag(bags, {.frames = 13});
  expect_begun(1);
  expect_begun(0);
  std::ofstream(bags + "/camera.yaml", std::ios::app) << "# measured once more\n";
  expect_begun(1);
  expect_begun(0);
}

TEST(BatchCommand, ResultsOfAnotherSourceStay) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", out = folder / "out", bags = folder / "bags";
  WriteBag(bags, {});
  const std::string bag = bags + "/w.mcap?image=/cam/compressed&depth=/depth/compressedDepth";
  WriteLines(list, {bag});
  ASSERT_EQ(Batch({list, "--out", out}).status, 0);
  ASSERT_EQ(
      RunAlidade({"run", kRoom + "15", "--sensor", "rgbd", "--out", out + "/w", "--overwrite"})
          .status,
      0);
  const std::string room = ReadText(out + "/w/map.alidade");
  // A name that the batch chose gives way, one that was given is refused.
  EXPECT_EQ(Batch({list, "--out", out}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(out + "/w-2/map.alidade"));
  WriteLines(list, {bag + " --out w"});
  const ProgramResult taken = Batch({list, "--out", out});
  EXPECT_EQ(taken.status, 1);
  EXPECT_THAT(taken.out, HasSubstr("--overwrite"));
  EXPECT_EQ(ReadText(out + "/w/map.alidade"), room);
  EXPECT_EQ(Batch({list, "--out", out, "--", "--overwrite"}).status, 0);
  EXPECT_NE(ReadText(out + "/w/map.alidade"), room);
  EXPECT_THAT(Batch({list, "--out", out}).out, HasSubstr("1 of 1 recordings are done already"));
}

TEST(BatchCommand, SameBytesAsRun) {
  const TempFolder folder;
  WriteLines(folder / "list.txt", {kRoom + "20 --out a"});
  ASSERT_EQ(Batch({folder / "list.txt", "--out", folder / "out", "--", "--sensor", "rgbd"}).status,
            0);
  ASSERT_EQ(RunAlidade({"run", kRoom + "20", "--sensor", "rgbd", "--out", folder / "alone"}).status,
            0);
  for (const char* file : {"/trajectory.txt", "/map.alidade"})
    EXPECT_EQ(ReadText(folder / "out/a" + file), ReadText(folder / "alone" + file)) << file;
}

TEST(BatchCommand, AgainstAnEarlierOneWhatIsWorseIsStatus1) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", before = folder / "before", now = folder / "now";
  WriteLines(list, {kRoom + "20 --out a --sensor rgbd"});
  ASSERT_EQ(Batch({list, "--out", before}).status, 0);
  const ProgramResult same = Batch({list, "--out", now, "--against", before});
  EXPECT_EQ(same.status, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("No result is worse"));
  // Had it been better before:
  auto json = nlohmann::json::parse(ReadText(before + "/batch.json"));
  const double ate = json["recordings"][0]["ate"].get<double>();
  json["recordings"][0]["ate"] = 0.5 * ate;
  WriteLines(before + "/batch.json", {json.dump()});
  const ProgramResult worse = Batch({list, "--out", now, "--against", before});
  EXPECT_EQ(worse.status, 1);
  EXPECT_THAT(worse.out, HasSubstr("worse: a: ATE"));
  EXPECT_EQ(Batch({list, "--out", now, "--against", before, "--worse-ate", "1m"}).status, 0);
}

// The names in the table of compare.html, in their order.
std::vector<std::string> NamesOnPage(const std::string& out) {
  const std::string page = ReadText(out + "/compare.html"), before = "</span>", after = "</th>";
  std::vector<std::string> names;
  for (size_t at = 0; (at = page.find(before, at)) != std::string::npos;) {
    at += before.size();
    const size_t end = page.find('<', at);
    if (page.compare(end, after.size(), after) == 0) names.push_back(page.substr(at, end - at));
  }
  return names;
}

TEST(BatchCommand, TheEarlierOneIsShownBesideTheNew) {
  using testing::ElementsAre;
  const TempFolder folder;
  const std::string list = folder / "list.txt", before = folder / "monday",
                    now = folder / "tuesday";
  const std::string a = kRoom + "20 --out a --sensor rgbd", b = kRoom + "15 --out b --sensor rgbd";
  WriteLines(list, {a, b});
  ASSERT_EQ(Batch({list, "--out", before}).status, 0);
  EXPECT_THAT(NamesOnPage(before), ElementsAre("a", "b"));
  // Each before the new one of its name; what is new stands alone.
  WriteLines(list, {a, b, kRoom + "16 --out c --sensor rgbd"});
  ASSERT_EQ(Batch({list, "--out", now, "--against", before + "/"}).status, 0);
  EXPECT_THAT(NamesOnPage(now),
              ElementsAre("monday/a", "tuesday/a", "monday/b", "tuesday/b", "tuesday/c"));
  ASSERT_EQ(Batch({list, "--out", now, "--against", now}).status, 0);
  EXPECT_THAT(NamesOnPage(now), ElementsAre("a", "b", "c"));
  // One whose folder is gone is told, and judged all the same.
  std::filesystem::remove_all(before + "/b");
  const ProgramResult gone = Batch({list, "--out", now, "--against", before + "/batch.json"});
  EXPECT_EQ(gone.status, 0) << gone.err;
  EXPECT_THAT(gone.out, HasSubstr("compare.html: b: "));
  EXPECT_THAT(gone.out, HasSubstr("No result is worse"));
  EXPECT_THAT(NamesOnPage(now), ElementsAre("monday/a", "tuesday/a", "tuesday/b", "tuesday/c"));
  // A single recording has its earlier self to be compared with; folders of one name are told
  // apart.
  WriteLines(list, {a});
  const std::string same = folder / "again/monday";
  std::filesystem::create_directory(folder / "again");
  ASSERT_EQ(Batch({list, "--out", same, "--against", before}).status, 0);
  EXPECT_THAT(NamesOnPage(same), ElementsAre(before + "/a", same + "/a"));
}

TEST(BatchCommand, CtrlCLeavesWhatIsDone) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", out = folder / "out";
  WriteLines(list, {kRoom + "15 --out a --sensor rgbd", kRoom + "3000 --out b --sensor rgbd"});
  const ProgramResult cut =
      RunAlidade({"batch", list, "--out", out, "--jobs", "1"}, [&](pid_t batch) {
        for (int i = 0; i < 600; ++i) {
          std::this_thread::sleep_for(std::chrono::milliseconds(100));
          if (Lines(ReadText(out + "/batch.log"), " begun b\n") > 0) break;
        }
        kill(batch, SIGINT);
      });
  EXPECT_EQ(cut.status, 130);
  const auto json = nlohmann::json::parse(ReadText(out + "/batch.json"));
  EXPECT_EQ(json["recordings"][0]["state"], "ok");
  EXPECT_EQ(json["recordings"][1]["state"], "interrupted");
  WriteLines(list, {kRoom + "15 --out a --sensor rgbd", kRoom + "16&seed=2 --out b --sensor rgbd"});
  const ProgramResult rest = Batch({list, "--out", out, "--merge", "--", "--overwrite"});
  EXPECT_EQ(rest.status, 0) << rest.out << rest.err;
  EXPECT_THAT(rest.out, HasSubstr("1 of 2 recordings are done already"));
  EXPECT_TRUE(std::filesystem::exists(out + "/merged/map.alidade"));
}

TEST(BatchCommand, MergesWhatCanBeMerged) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", out = folder / "out";
  WriteLines(list, {kRoom + "15 --out a --sensor rgbd", kRoom + "15 --out again --sensor rgbd",
                    kRoom + "16&seed=2 --out b --sensor rgbd",
                    kRoom + "12 --out wide --sensor rgbd "
                            "--fov 70"});
  const ProgramResult result = Batch({list, "--out", out, "--merge"});
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("Not merged: again is the same map as a"));
  EXPECT_THAT(result.out, HasSubstr("Not merged: wide with "));
  EXPECT_THAT(result.out, HasSubstr("another camera"));
  EXPECT_TRUE(std::filesystem::exists(out + "/merged/a.txt"));
  EXPECT_TRUE(std::filesystem::exists(out + "/merged/b.txt"));
  EXPECT_FALSE(std::filesystem::exists(out + "/merged/wide.txt"));
}

TEST(BatchCommand, RefusesAWrongListBeforeAnythingIsRun) {
  const TempFolder folder;
  const std::string list = folder / "list.txt", out = folder / "out";
  const auto complaint = [&](const std::string& line) {
    WriteLines(list, {kRoom + "15", line});
    const ProgramResult result = Batch({list, "--out", out});
    EXPECT_EQ(result.status, 2) << line;
    EXPECT_FALSE(std::filesystem::exists(out)) << line;
    return result.err;
  };
  EXPECT_THAT(complaint("x --sensr mono"), HasSubstr("list.txt:2: unknown option --sensr"));
  EXPECT_THAT(complaint("x --sensor sonar"), HasSubstr("list.txt:2: --sensor"));
  EXPECT_THAT(complaint("x --set tracker.nothing=1"), HasSubstr("list.txt:2: "));
  EXPECT_THAT(complaint("x --viewer"), HasSubstr("cannot be used in a batch"));
  WriteLines(list, {kRoom + "15"});
  const ProgramResult full = Batch({list, "--out", folder.path()});
  EXPECT_EQ(full.status, 3);  // it holds the list
  EXPECT_THAT(full.err, HasSubstr("other files than those of a batch"));
}

}  // namespace
}  // namespace alidade::batch_command_test
