// Files that are there stay, unless the command that wrote them writes them again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include "support/program.h"
#include "support/rendered.h"

namespace alidade::files_kept_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FilesKept : public testing::Test {
 protected:
  ProgramResult Alidade(const std::vector<std::string>& words) {
    return RunAlidade(words, nullptr, at_.path());
  }
  void ExpectDone(const std::vector<std::string>& words) {
    const ProgramResult result = Alidade(words);
    EXPECT_EQ(result.status, 0) << result.err;
  }
  // Refused with one line in which there is `words`, and `file` as it was.
  void ExpectKept(const std::string& file, const std::vector<std::string>& command, int status,
                  const std::string& words) {
    const std::string before = ReadText(at_ / file);
    ASSERT_NE(before, "");
    const ProgramResult result = Alidade(command);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_TRUE(ReadText(at_ / file) == before) << file;
  }
  void Run(const std::string& name, const std::string& sensor = "rgbd", int seed = 1) {
    ExpectDone({"run", "synth:desk?width=320&height=240&frames=12&seed=" + std::to_string(seed),
                "--sensor", sensor, "--quiet", "--out", name});
  }
  TempFolder at_;
};

TEST_F(FilesKept, ACalibrationGivesWayToOneOfTheSameRecordings) {
  const std::string desk = "synth:desk?width=320&height=240&fov=66&frames=60&seed=";  // is enough
  const std::string one = desk + "1";
  ExpectDone({"calibrate", one});
  ExpectKept("camera.yaml", {"calibrate", desk + "2"}, 3, "camera.yaml");
  ExpectKept("camera.yaml", {"calibrate", one, desk + "2"}, 3, "--overwrite");
  at_.Write("camera.yaml", "model: pinhole\n");
  ExpectKept("camera.yaml", {"calibrate", one}, 3, "camera.yaml");
  ExpectDone({"calibrate", one, "--overwrite"});
  EXPECT_THAT(ReadText(at_ / "camera.yaml"), HasSubstr("fx: "));
}

TEST_F(FilesKept, APageOfCompareGivesWayToTheNext) {
  Run("a");
  Run("b", "mono");
  ExpectDone({"compare", "a", "b"});
  ExpectDone({"compare", "b", "a"});
  at_.Write("compare.html", "<!doctype html>\nmine");
  ExpectKept("compare.html", {"compare", "a", "b"}, 3, "compare.html");
  ExpectKept("a/report.html", {"compare", "a", "b", "--out", "a/report.html"}, 2, "a/report.html");
}

TEST_F(FilesKept, ResultsAreNotWrittenOverByOtherCommands) {
  Run("a");
  Run("b");
  ExpectKept("a/trajectory.txt", {"export", "a", "--to", "tum", "a/trajectory.txt"}, 2,
             "alidade run");
  ExpectKept("b/map.alidade", {"export", "a", "--to", "ply", "b/map.alidade"}, 2, "alidade run");
  ExpectKept("a/landmarks.ply", {"calibrate", "synth:desk", "--out", "a/landmarks.ply"}, 2,
             "a/landmarks.ply");
  ExpectKept("a/report.html",
             {"run", "synth:desk?width=320&height=240&frames=3", "--record-to", "a/report.html"}, 2,
             "a/report.html");
  ExpectDone({"export", "a", "--to", "tum", "a/keyframes_of_the_map.txt"});
}

TEST_F(FilesKept, AMergedMapGivesWayToOneOfTheSameMaps) {
  Run("a");
  Run("b", "rgbd", 2);
  Run("c", "rgbd", 3);
  ExpectDone({"merge", "a", "b", "--out", "both"});
  ExpectDone({"merge", "b", "a", "--out", "both"});
  ExpectKept("both/map.alidade", {"merge", "a", "c", "--out", "both"}, 2, "--overwrite");
  ExpectDone({"merge", "a", "c", "b", "--out", "both"});  // and more
  ExpectKept("both/map.alidade", {"merge", "a", "b", "--out", "both"}, 2, "--overwrite");
  ExpectDone({"merge", "a", "b", "--out", "both", "--overwrite"});
  EXPECT_FALSE(fs::exists(at_ / "both/c.txt"));
  // A saved map, and a text of somebody's.
  fs::copy(at_ / "a/map.alidade", at_ / "saved.alidade");
  ExpectKept("saved.alidade", {"merge", "b", "c", "--out", "saved.alidade"}, 2, "saved.alidade");
  at_.Write("house/b.txt", "what I know of b");
  ExpectKept("house/b.txt", {"merge", "a", "b", "--out", "house"}, 2, "house/b.txt");
}

TEST_F(FilesKept, ARenderedRecordingStaysUntilTheNextIsWhole) {
  const std::vector<std::string> synth = {"synth", "desk",     "out", "--width",
                                          "160",   "--height", "120", "--frames"};
  const auto render = [&](const std::string& frames, const std::function<void(pid_t)>& meanwhile) {
    std::vector<std::string> words = synth;
    words.push_back(frames);
    return RunAlidade(words, meanwhile, at_.path());
  };
  ASSERT_EQ(render("4", nullptr).status, 0);
  at_.Write("out/rgb/mine.png", "mine");
  at_.Write("out/notes.txt", "mine as well");
  const auto lines = [&] { return ReadLines(at_ / "out/rgb.txt").size(); };
  const ProgramResult killed = render("100000", [&](pid_t program) {
    for (int i = 0; i < 3000; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (fs::exists(at_ / "out/synth.lock")) break;
    }
    const ProgramResult second = render("4", nullptr);
    EXPECT_EQ(second.status, 3);
    EXPECT_THAT(second.err, HasSubstr("process " + std::to_string(program)));
    kill(program, SIGKILL);
  });
  EXPECT_EQ(killed.status, -1);
  EXPECT_EQ(lines(), 5u);
  ASSERT_EQ(render("6", nullptr).status, 0);
  EXPECT_EQ(lines(), 7u);
  EXPECT_EQ(ReadText(at_ / "out/rgb/mine.png") + ReadText(at_ / "out/notes.txt"),
            "minemine as well");
  for (const auto& entry : fs::directory_iterator(at_ / "out")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name.find(".tmp") == std::string::npos && name.find(".lock") == std::string::npos)
        << name;
  }
}

}  // namespace
}  // namespace alidade::files_kept_test
