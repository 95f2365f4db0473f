// Nothing is lost in any order of commands with their default folders: those that end well, that
// fail, that are interrupted, that are killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "alidade/base/random.h"
#include "support/program.h"
#include "support/sliding_recording.h"

namespace alidade::results_in_any_order_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Files = std::map<std::string, std::string>;

enum class Ends { kByItself, kInterrupted, kKilled };

struct Step {
  std::vector<std::string> words;
  Ends ends = Ends::kByItself;
  std::vector<std::string> outputs = {};  // beginnings of the files the command is to write
};

// Whose results are in a folder, and how much of them there is.
struct Result {
  std::string command, source;
  bool good = false;
  double frames = 0;
};

class AnyOrder : public testing::Test {
 protected:
  AnyOrder() {
    Recording("a/walk", 12);
    Recording("b/walk", 14, /*black=*/false, /*step=*/2);
    Recording("dark/walk", 12, /*black=*/true);
    at_.Write("list.txt", "a/walk\nb/walk\ndark/walk\n");
  }
  void Recording(const std::string& name, int frames, bool black = false, int step = 3) {
    const TempFolder draft;
    SlidingRecording options;
    options.frames = frames;
    options.step = step;
    WriteSlidingTum(draft, options);
    for (int i = 0; black && i < frames; ++i)
      WriteImage(draft / SlidingImage(i), cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)));
    fs::create_directories(fs::path(at_ / name).parent_path());
    fs::copy(draft.path(), at_ / name, fs::copy_options::recursive);
  }
  Files AllFiles() {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(at_.path())) {
      if (entry.is_regular_file())
        files[fs::relative(entry.path(), at_.path()).string()] = ReadText(entry.path());
    }
    return files;
  }
  // By folder. Attempts that did not become results are left out.
  std::map<std::string, Result> Results(const Files& files) {
    std::map<std::string, Result> results;
    for (const auto& [name, bytes] : files) {
      const fs::path path = name;
      if (path.filename() != "stats.json" || name.find("last-attempt") != std::string::npos ||
          name.find("run.tmp") != std::string::npos)
        continue;
      const json stats = json::parse(bytes);
      const json folder = stats.value("folder", json::object());
      results[path.parent_path()] = {folder.value("command", ""), folder.value("source", ""),
                                     folder.value("complete", false) && stats["tracked"] > 0,
                                     stats["frames"]};
    }
    return results;
  }
  void Play(const Step& step) {
    const auto end = [&](pid_t program) {
      if (step.ends == Ends::kByItself) return;
      for (int i = 0; i < 3000 && !IsAtWork(program); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      kill(program, step.ends == Ends::kKilled ? SIGKILL : SIGINT);
    };
    const ProgramResult result = RunAlidade(step.words, end, at_.path());
    EXPECT_NE(result.status, 70) << result.err;
    EXPECT_EQ(result.status == -1, step.ends == Ends::kKilled) << result.err;
  }
  bool IsAtWork(pid_t program) {
    std::error_code gone;  // while it is looked at
    for (fs::recursive_directory_iterator it(at_ / "alidade-out", gone), end; !gone && it != end;
         it.increment(gone)) {
      if (it->path().filename() == "run.lock" &&
          ReadText(it->path()).find("process " + std::to_string(program) + " ") == 0)
        return true;
    }
    return false;
  }
  // What is there stays, or is replaced by the same command on the same source with no less.
  void ExpectKept(const Files& before, const Files& after, const Step& step) {
    const auto results_before = Results(before), results_after = Results(after);
    for (const auto& [folder, result] : results_before) {
      if (!result.good) continue;
      const auto now = results_after.find(folder);
      ASSERT_TRUE(now != results_after.end()) << folder << " is gone";
      EXPECT_TRUE(now->second.good) << folder;
      EXPECT_EQ(now->second.command, result.command) << folder;
      EXPECT_EQ(now->second.source, result.source) << folder;
      EXPECT_GE(now->second.frames, result.frames) << folder;
    }
    const std::string source =
        step.words.size() > 1 ? fs::weakly_canonical(at_ / step.words[1]).string() : "";
    for (const auto& [name, bytes] : before) {
      const auto now = after.find(name);
      if (now != after.end() && now->second == bytes) continue;
      bool may_change = name.find("last-attempt/") != std::string::npos ||
                        name.find("run.tmp") != std::string::npos ||
                        fs::path(name).filename() == "run.lock";
      const bool own_file = fs::path(name).filename() != "notes.txt";
      const auto result = results_before.find(fs::path(name).parent_path());
      if (own_file && result != results_before.end())
        may_change |= !result->second.good ||
                      (result->second.command == step.words[0] && result->second.source == source);
      for (const std::string& output : step.outputs) may_change |= name.rfind(output, 0) == 0;
      EXPECT_TRUE(may_change) << name << (now == after.end() ? " is gone" : " is another");
    }
  }
  // `left`: files that are there in the end.
  void PlayAll(const std::vector<Step>& steps, const std::vector<std::string>& left) {
    Files before = AllFiles();
    for (const Step& step : steps) {
      std::string words;
      for (const std::string& word : step.words) words += word + " ";
      SCOPED_TRACE(words);
      Play(step);
      // A user puts something beside the results.
      for (const auto& [folder, result] : Results(AllFiles()))
        at_.Write(folder + "/notes.txt", "about " + folder);
      const Files after = AllFiles();
      ExpectKept(before, after, step);
      before = after;
    }
    for (const auto& [name, bytes] : before)
      EXPECT_EQ(name.find("run.done"), std::string::npos) << name;
    for (const std::string& name : left) EXPECT_TRUE(before.count(name)) << name;
  }

  TempFolder at_;
};

const Step kRunA{{"run", "a/walk"}}, kRunB{{"run", "b/walk"}}, kRunDark{{"run", "dark/walk"}},
    kRunPart{{"run", "a/walk", "--last", "5"}}, kRunNothing{{"run", "nowhere/walk"}},
    kKilledA{{"run", "a/walk", "--rate", "0.1", "--record"}, Ends::kKilled},
    kKilledB{{"run", "b/walk", "--rate", "0.1", "--record"}, Ends::kKilled},
    kInterruptedA{{"run", "a/walk", "--rate", "0.1"}, Ends::kInterrupted},
    kLocalizeA{{"localize", "a/walk", "--map", "alidade-out/walk"}},
    kLocalizeB{{"localize", "b/walk", "--map", "alidade-out/walk"}},
    kKilledLocalize{{"localize", "a/walk", "--map", "alidade-out/walk", "--rate", "0.1"},
                    Ends::kKilled},
    kGoOn{{"run", "b/walk", "--load", "alidade-out/walk"}},
    kPly{{"export", "alidade-out/walk", "--to", "ply", "walk.ply"}, {}, {"walk.ply"}},
    kColmap{{"export", "alidade-out/walk", "--to", "colmap", "model"}, {}, {"model/"}},
    kMerge{{"merge", "alidade-out/walk", "alidade-out/walk-2", "--out", "both"}, {}, {"both/"}},
    kCompare{{"compare", "alidade-out/walk", "alidade-out/walk-2"}, {}, {"compare.html"}},
    kCalibrate{{"calibrate", "a/walk"}, {}, {"camera.yaml"}},
    kSynth{{"synth", "desk", "desk", "--frames", "3", "--width", "160", "--height", "120"},
           {},
           {"desk/"}},
    kRunSynth{{"run", "desk"}},
    kBatch{{"batch", "list.txt", "--out", "many", "--merge"},
           {},
           {"many/log/", "many/done/", "many/batch", "many/compare.html", "many/merged/"}};

TEST_F(AnyOrder, RunsOfSourcesOfOneName) {
  PlayAll({kRunA, kRunB, kRunDark, kRunA, kRunPart, kRunNothing, kRunDark, kRunB},
          {"alidade-out/walk/map.alidade", "alidade-out/walk/last-attempt/stats.json",
           "alidade-out/walk-2/map.alidade", "alidade-out/walk-3/report.html"});
}

TEST_F(AnyOrder, RunsThatAreCutOff) {
  PlayAll({kKilledA, kRunA, kKilledA, kInterruptedA, kKilledB, kRunB, kInterruptedA, kRunA},
          {"alidade-out/walk/map.alidade", "alidade-out/walk-2/map.alidade"});
}

TEST_F(AnyOrder, AnInterruptedRunFirst) {
  PlayAll({kInterruptedA, kRunB, kRunDark, kRunA, kInterruptedA, kRunPart},
          {"alidade-out/walk/map.alidade", "alidade-out/walk-2/map.alidade"});
}

TEST_F(AnyOrder, LocalizingAndGoingOn) {
  PlayAll({kRunA, kLocalizeA, kLocalizeB, kRunA, kGoOn, kKilledLocalize, kLocalizeA, kRunB},
          {"alidade-out/walk-localized/trajectory.txt",
           "alidade-out/walk-localized-2/trajectory.txt", "alidade-out/walk-2/map.alidade"});
}

TEST_F(AnyOrder, CommandsThatTakeResults) {
  PlayAll({kRunA, kRunB, kPly, kColmap, kMerge, kCompare, kRunDark, kCalibrate, kMerge, kRunPart,
           kPly, kColmap, kCompare},
          {"walk.ply", "model/export.json", "both/map.alidade", "compare.html"});
}

TEST_F(AnyOrder, BatchesAndRenderedRecordings) {
  PlayAll({kSynth, kRunSynth, kBatch, kRunA, kBatch, kSynth, kRunSynth, kBatch},
          {"desk/rgb.txt", "alidade-out/desk/stats.json", "many/walk/map.alidade",
           "many/walk-2/map.alidade", "many/merged/map.alidade"});
}

// Whatever it was doing then.
TEST_F(AnyOrder, ARunThatIsKilledLeavesAWholeResult) {
  const std::vector<std::string> words = {"run", "a/walk", "--record", "--seed"};
  const auto run = [&](const std::string& seed, const std::function<void(pid_t)>& meanwhile) {
    std::vector<std::string> all = words;
    all.push_back(seed);
    return RunAlidade(all, meanwhile, at_.path()).status;
  };
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run("1", nullptr), 0);
  const auto taken = std::chrono::duration_cast<std::chrono::microseconds>(
                         std::chrono::steady_clock::now() - start)
                         .count();
  Random random(7);
  const std::string folder = at_ / "alidade-out/walk";
  int replaced = 0;
  for (int i = 2; i < 17; ++i) {
    const auto wait = static_cast<useconds_t>(random.Below(static_cast<int>(2 * taken)));
    run(std::to_string(i), [&](pid_t program) {
      usleep(wait);
      kill(program, SIGKILL);
    });
    const bool placing = fs::exists(folder + "/run.done/stats.json");
    if (placing) continue;  // the next run goes on with it
    const json stats = json::parse(ReadText(folder + "/stats.json"));
    for (const std::string file : stats["folder"]["files"])
      EXPECT_TRUE(fs::exists(folder + "/" + file)) << file << " of kill " << i;
    replaced += stats["settings"]["seed"] == i;
  }
  std::printf("of 15 kills %d came after the results were in their place\n", replaced);
  ASSERT_EQ(run("17", nullptr), 0);
  EXPECT_EQ(json::parse(ReadText(folder + "/stats.json"))["settings"]["seed"], 17);
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_EQ(entry.path().filename().string().find("run.t"), std::string::npos) << entry.path();
}

// Killed while its files were moved to their place.
TEST_F(AnyOrder, FilesOnTheirWayArriveWithTheNextRun) {
  const auto alidade = [&](const std::vector<std::string>& words) {
    return RunAlidade(words, nullptr, at_.path()).status;
  };
  const std::vector<std::string> old_run = {"run",      "a/walk", "--seed", "1",
                                            "--record", "--out",  "old"};
  ASSERT_EQ(alidade(old_run), 0);
  ASSERT_EQ(alidade({"run", "a/walk", "--seed", "2", "--out", "new"}), 0);
  Files expected;
  for (const auto& [name, bytes] : AllFiles()) {
    if (name.rfind("new/", 0) == 0) expected[name.substr(4)] = bytes;
  }
  expected["notes.txt"] = "mine";
  for (int moved = -2; moved < 4; ++moved) {
    SCOPED_TRACE(moved);
    const std::string out = at_ / "out";
    fs::remove_all(out);
    fs::copy(at_ / "old", out);
    at_.Write("out/notes.txt", "mine");
    fs::copy(at_ / "new", out + "/run.done");
    if (moved > -2) fs::rename(out + "/stats.json", out + "/run.done/replaced.json");
    if (moved > -2) fs::remove(out + "/map.alidade");
    if (moved > -1) {  // all of the earlier run's are gone
      for (const auto& entry : fs::directory_iterator(at_ / "old"))
        fs::remove(out + "/" + entry.path().filename().string());
      fs::remove(out + "/run.done/replaced.json");
    }
    const char* names[] = {"map.alidade", "trajectory.txt", "report.html"};
    for (int i = 0; i < moved; ++i) fs::rename(out + "/run.done/" + names[i], out + "/" + names[i]);
    EXPECT_EQ(alidade({"run", "b/walk", "--out", "out"}), 3);  // refused, after that
    Files found;
    for (const auto& entry : fs::directory_iterator(out))
      found[entry.path().filename()] = ReadText(entry.path());
    EXPECT_TRUE(found == expected) << testing::PrintToString(found.size());
  }
}

}  // namespace
}  // namespace alidade::results_in_any_order_test
