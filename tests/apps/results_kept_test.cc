// Results that are there stay, whatever is run next, and however it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/program.h"
#include "support/sliding_recording.h"

namespace alidade::results_kept_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

using Files = std::map<std::string, std::string>;

// What is in a folder, by name.
Files FilesIn(const std::string& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder).string()] = ReadText(entry.path());
  }
  return files;
}

// Waits for a minute at most.
bool WaitFor(const std::function<bool()>& condition) {
  for (int i = 0; i < 3000 && !condition(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return condition();
}

// Commands are run in a folder of their own, so that default folders are in it.
class ResultsKept : public testing::Test {
 protected:
  // A recording of 12 frames that can be tracked, or of black ones.
  std::string Recording(const std::string& name, bool black = false) {
    const TempFolder draft;
    WriteSlidingTum(draft);
    for (int i = 0; black && i < 12; ++i)
      WriteImage(draft / SlidingImage(i), cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)));
    fs::create_directories(fs::path(at_ / name).parent_path());
    fs::copy(draft.path(), at_ / name, fs::copy_options::recursive);
    return name;
  }
  ProgramResult Alidade(const std::vector<std::string>& words,
                        const std::function<void(pid_t)>& while_running = nullptr) {
    return RunAlidade(words, while_running, at_.path());
  }
  void ExpectDone(const std::vector<std::string>& words) {
    const ProgramResult result = Alidade(words);
    EXPECT_EQ(result.status, 0) << result.err;
  }
  nlohmann::json Stats(const std::string& folder) {
    return nlohmann::json::parse(ReadText(at_ / folder + "/stats.json"), nullptr, false);
  }
  // A run that takes two minutes, and is killed once its stream is being written.
  void RunAndKill(const std::string& out) {
    const ProgramResult result =
        Alidade({"run", "long", "--rate", "0.1", "--record", "--out", out}, [&](pid_t program) {
          EXPECT_TRUE(WaitFor([&] { return !NamesWith(out, "run.stream.tmp").empty(); }));
          kill(program, SIGKILL);
        });
    EXPECT_EQ(result.status, -1) << result.err;
  }
  // Everything below a folder whose name has `part` in it.
  std::vector<std::string> NamesWith(const std::string& folder, const std::string& part) {
    std::vector<std::string> names;
    std::error_code gone;  // while it is looked at
    for (fs::recursive_directory_iterator it(at_ / folder, gone), end; !gone && it != end;
         it.increment(gone)) {
      if (it->path().filename().string().find(part) != std::string::npos)
        names.push_back(it->path().string());
    }
    return names;
  }

  TempFolder at_;
};

TEST_F(ResultsKept, AreCalledAsTheSourceWasTyped) {
  Recording("kitchen_walk");
  fs::create_directory_symlink("kitchen_walk", at_ / "walk");
  ExpectDone({"run", "walk/"});
  EXPECT_TRUE(fs::exists(at_ / "alidade-out/walk/stats.json"));
  EXPECT_FALSE(fs::exists(at_ / "alidade-out/kitchen_walk"));
  // A dot has no name of its own.
  const ProgramResult here = RunAlidade({"run", "."}, nullptr, at_ / "kitchen_walk");
  EXPECT_EQ(here.status, 0) << here.err;
  EXPECT_TRUE(fs::exists(at_ / "kitchen_walk/alidade-out/kitchen_walk/stats.json"));
}

TEST_F(ResultsKept, LocalizeHasAFolderOfItsOwn) {
  Recording("monday");
  Recording("tuesday");
  ExpectDone({"run", "monday"});
  ExpectDone({"run", "tuesday"});
  const Files before = FilesIn(at_ / "alidade-out/tuesday");
  ASSERT_TRUE(before.count("map.alidade"));
  ExpectDone({"localize", "tuesday", "--map", "alidade-out/monday/map.alidade"});
  EXPECT_EQ(FilesIn(at_ / "alidade-out/tuesday"), before);
  EXPECT_TRUE(fs::exists(at_ / "alidade-out/tuesday-localized/trajectory.txt"));
  EXPECT_FALSE(fs::exists(at_ / "alidade-out/tuesday-localized/map.alidade"));
  // Not even when it is sent there.
  const ProgramResult there =
      Alidade({"localize", "tuesday", "--map", "alidade-out/monday/map.alidade", "--out",
               "alidade-out/tuesday"});
  EXPECT_EQ(there.status, 3);
  EXPECT_THAT(there.err, HasSubstr("alidade run tuesday"));
  EXPECT_THAT(there.err, HasSubstr("--overwrite"));
  EXPECT_EQ(FilesIn(at_ / "alidade-out/tuesday"), before);
}

TEST_F(ResultsKept, AnotherSourceOfTheSameNameHasAFolderOfItsOwn) {
  Recording("a/walk");
  Recording("b/walk");
  Recording("c/walk", /*black=*/true);
  ExpectDone({"run", "a/walk"});
  const Files before = FilesIn(at_ / "alidade-out/walk");
  const ProgramResult second = Alidade({"run", "b/walk"});
  EXPECT_EQ(second.status, 0);
  EXPECT_THAT(second.err,
              HasSubstr("alidade-out/walk contains the results of `alidade run a/walk`"));
  EXPECT_THAT(second.out, HasSubstr("alidade-out/walk-2"));
  EXPECT_EQ(Alidade({"run", "c/walk"}).status, 4);
  EXPECT_EQ(FilesIn(at_ / "alidade-out/walk"), before);
  EXPECT_EQ(Stats("alidade-out/walk-2")["source"], "b/walk");
  EXPECT_EQ(Stats("alidade-out/walk-3")["source"], "c/walk");
  // Each comes back to its own, from wherever it is named.
  ExpectDone({"run", at_ / "b/walk"});
  EXPECT_EQ(Stats("alidade-out/walk-2")["source"], at_ / "b/walk");
  EXPECT_FALSE(fs::exists(at_ / "alidade-out/walk-4"));
}

TEST_F(ResultsKept, AFolderThatWasNamedIsOfOneSource) {
  Recording("a/walk");
  Recording("b/walk", /*black=*/true);
  ExpectDone({"run", "a/walk", "--out", "out"});
  const Files before = FilesIn(at_ / "out");
  const ProgramResult refused = Alidade({"run", "b/walk", "--out", "out"});
  EXPECT_EQ(refused.status, 3);
  for (const char* words : {"out", "alidade run a/walk", "alidade run b/walk", "--overwrite"})
    EXPECT_THAT(refused.err, HasSubstr(words));
  EXPECT_EQ(LineCount(refused.err), 1) << refused.err;
  EXPECT_EQ(FilesIn(at_ / "out"), before);
  EXPECT_EQ(Alidade({"run", "b/walk", "--out", "out", "--overwrite"}).status, 4);
  EXPECT_EQ(Stats("out")["source"], "b/walk");
  // Of a run in which nothing was mapped there is nothing to keep.
  ExpectDone({"run", "a/walk", "--out", "out"});
  EXPECT_EQ(Stats("out")["source"], "a/walk");
}

TEST_F(ResultsKept, AFailedRunLeavesTheEarlierResult) {
  Recording("walk");
  ExpectDone({"run", "walk"});
  const Files before = FilesIn(at_ / "alidade-out/walk");
  // The recording goes black.
  fs::remove_all(at_ / "walk");
  Recording("walk", /*black=*/true);
  const ProgramResult failed = Alidade({"run", "walk"});
  EXPECT_EQ(failed.status, 4);
  EXPECT_THAT(failed.err, HasSubstr("alidade-out/walk/last-attempt"));
  EXPECT_EQ(LineCount(failed.err), 1) << failed.err;
  Files after = FilesIn(at_ / "alidade-out/walk");
  EXPECT_TRUE(after.count("last-attempt/report.html"));
  EXPECT_EQ(nlohmann::json::parse(after["last-attempt/stats.json"])["tracked"], 0);
  std::erase_if(after, [](const auto& file) { return file.first.rfind("last-attempt/", 0) == 0; });
  EXPECT_EQ(after, before);
  // It can be opened no more.
  fs::remove_all(at_ / "walk");
  EXPECT_EQ(Alidade({"run", "walk"}).status, 3);
  EXPECT_EQ(ReadText(at_ / "alidade-out/walk/map.alidade"), before.at("map.alidade"));
}

TEST_F(ResultsKept, LessDoesNotReplaceMore) {
  Recording("walk");
  ExpectDone({"run", "walk", "--out", "out"});
  const std::string map = ReadText(at_ / "out/map.alidade");
  const ProgramResult shorter = Alidade({"run", "walk", "--out", "out", "--last", "5"});
  EXPECT_EQ(shorter.status, 3);
  EXPECT_THAT(shorter.err, HasSubstr("12 frames"));
  EXPECT_THAT(shorter.err, HasSubstr("out/last-attempt"));
  EXPECT_EQ(Stats("out/last-attempt")["frames"], 6);
  const ProgramResult interrupted =
      Alidade({"run", "walk", "--out", "out", "--rate", "0.1"}, [&](pid_t program) {
        EXPECT_TRUE(WaitFor([&] { return !NamesWith("out", "run.lock").empty(); }));
        kill(program, SIGINT);
      });
  EXPECT_EQ(interrupted.status, 130);
  EXPECT_THAT(interrupted.out, HasSubstr("out/last-attempt"));
  EXPECT_LT(Stats("out/last-attempt")["frames"], 6);
  EXPECT_EQ(ReadText(at_ / "out/map.alidade"), map);
  EXPECT_EQ(Stats("out")["frames"], 12);
  ExpectDone({"run", "walk", "--out", "out", "--sensor", "rgbd", "--seed", "3"});  // as much: does
  EXPECT_EQ(Stats("out")["settings"]["seed"], 3);
  ExpectDone({"run", "walk", "--out", "out", "--last", "5", "--overwrite"});
  EXPECT_EQ(Stats("out")["frames"], 6);
}

TEST_F(ResultsKept, WhatARunDidNotWriteStays) {
  Recording("walk");
  ExpectDone({"run", "walk", "--out", "out"});
  at_.Write("out/groundtruth.txt", "# put beside the results, for compare\n");
  at_.Write("out/camera.yaml", ReadText(at_ / "walk/camera.yaml"));
  at_.Write("out/notes.txt", "mine");
  const Files mine = {{"groundtruth.txt", ReadText(at_ / "out/groundtruth.txt")},
                      {"camera.yaml", ReadText(at_ / "out/camera.yaml")},
                      {"notes.txt", "mine"}};
  ExpectDone({"run", "walk", "--out", "out", "--camera", "out/camera.yaml"});
  for (const auto& [name, bytes] : mine) EXPECT_EQ(ReadText(at_ / "out/" + name), bytes) << name;
  // What one run wrote and another is given stays as well, whoever wrote it.
  const std::string map = ReadText(at_ / "out/map.alidade");
  ExpectDone({"localize", "walk", "--map", "out", "--out", "out", "--overwrite"});
  EXPECT_EQ(ReadText(at_ / "out/map.alidade"), map);
  // Nor does a folder go because it is called as one of ours.
  at_.Write("out/run.done/notes.txt", "mine");
  EXPECT_EQ(Alidade({"run", "walk", "--out", "out", "--overwrite"}).status, 3);
  EXPECT_EQ(ReadText(at_ / "out/run.done/notes.txt"), "mine");
  fs::remove_all(at_ / "out/run.done");
  // Folders of older versions say nothing of their files.
  nlohmann::json stats = Stats("out");
  stats.erase("folder");
  at_.Write("out/stats.json", stats.dump());
  ExpectDone({"run", "walk", "--out", "out", "--overwrite"});
  for (const auto& [name, bytes] : mine) EXPECT_EQ(ReadText(at_ / "out/" + name), bytes) << name;
}

TEST_F(ResultsKept, WhatARunWroteGoesWithIt) {
  const std::string desk = "synth:desk?frames=40&width=320&height=240";
  ExpectDone({"run", desk, "--out", "out", "--record", "--semidense"});
  ASSERT_TRUE(fs::exists(at_ / "out/groundtruth.txt"));
  ASSERT_TRUE(fs::exists(at_ / "out/run.stream"));
  ASSERT_TRUE(fs::exists(at_ / "out/depth"));
  Recording("walk");
  ExpectDone({"run", "walk", "--out", "out", "--overwrite"});
  for (const char* name : {"groundtruth.txt", "run.stream", "depth", "depth.txt", "semidense.ply"})
    EXPECT_FALSE(fs::exists(at_ / "out/" + std::string(name))) << name;
}

TEST_F(ResultsKept, AFileThatIsNotOfARunIsNotWrittenOver) {
  const std::string desk = "synth:desk?frames=8&width=320&height=240";
  ExpectDone({"run", desk, "--out", "out"});
  Recording("walk");
  ExpectDone({"run", "walk", "--out", "out", "--overwrite"});
  at_.Write("out/groundtruth.txt", "mine");
  const ProgramResult again = Alidade({"run", desk, "--out", "out", "--overwrite"});
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("out/groundtruth.txt"));
  EXPECT_EQ(ReadText(at_ / "out/groundtruth.txt"), "mine");
  ExpectDone({"run", "walk", "--out", "out", "--overwrite"});
  EXPECT_EQ(ReadText(at_ / "out/groundtruth.txt"), "mine");
}

TEST_F(ResultsKept, ARunThatWasKilledIsNoHindrance) {
  Recording("long");
  RunAndKill("out");
  EXPECT_FALSE(fs::exists(at_ / "out/stats.json"));
  ExpectDone({"run", "long", "--out", "out"});
  EXPECT_TRUE(NamesWith("out", ".tmp").empty());
  const Files before = FilesIn(at_ / "out");
  RunAndKill("out");  // over a good one
  for (const auto& [name, bytes] : before) EXPECT_EQ(ReadText(at_ / "out/" + name), bytes) << name;
  ExpectDone({"run", "long", "--out", "out"});
  EXPECT_TRUE(NamesWith("out", ".tmp").empty());
  EXPECT_TRUE(NamesWith("out", "lock").empty());
  // As older versions left it.
  at_.Write("old/run.stream.tmp123-0", "half a stream");
  ExpectDone({"run", "long", "--out", "old"});
  EXPECT_TRUE(NamesWith("old", ".tmp").empty());
}

TEST_F(ResultsKept, AFolderIsOfOneRunAtATime) {
  Recording("walk");
  std::string holder;
  const ProgramResult first =
      Alidade({"run", "walk", "--out", "out", "--rate", "0.1"}, [&](pid_t program) {
        EXPECT_TRUE(WaitFor([&] { return !NamesWith("out", "run.lock").empty(); }));
        holder = "process " + std::to_string(program);
        for (const char* command : {"run", "localize"}) {
          std::vector<std::string> words = {command, "walk", "--out", "out"};
          if (words[0] == "localize") {
            ExpectDone({"run", "walk", "--out", "map"});
            words.insert(words.end(), {"--map", "map", "--overwrite"});
          }
          const ProgramResult second = Alidade(words);
          EXPECT_EQ(second.status, 3);
          EXPECT_THAT(second.err, HasSubstr(holder));
          EXPECT_THAT(second.err, HasSubstr("out"));
          EXPECT_EQ(LineCount(second.err), 1) << second.err;
          EXPECT_EQ(second.out, "");
        }
        kill(program, SIGINT);
      });
  EXPECT_EQ(first.status, 130) << first.err;
  EXPECT_LT(Stats("out")["frames"], 12);
  EXPECT_TRUE(NamesWith("out", "lock").empty());
}

}  // namespace
}  // namespace alidade::results_kept_test
