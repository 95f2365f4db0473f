// What `alidade` does with pipes, devices, links in a circle and hostile text where files are
// expected, and with numbers nobody can mean.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <thread>

#include "support/rendered.h"

namespace alidade::bad_files_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A program that waits for ever is ended, which fails the test as a crash would.
void EndIfItHangs(pid_t process) {
  constexpr int kSlices = 1200;  // of 0.1 s: two minutes, on however slow a machine
  for (int i = 0; i < kSlices; ++i) {
    siginfo_t info{};
    if (waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) != 0) return;
    if (info.si_pid == process) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  kill(process, SIGKILL);
}

class BadFiles : public testing::Test {
 protected:
  std::string Recording() {
    return CopyOf(Rendered({"room", "--frames", "30", "--seed", "5"}), folder_);
  }
  std::string Pipe(const std::string& name) {
    EXPECT_EQ(mkfifo((folder_ / name).c_str(), 0600), 0);
    return folder_ / name;
  }
  static ProgramResult Alidade(const std::vector<std::string>& arguments) {
    return RunAlidade(arguments, EndIfItHangs);
  }
  ProgramResult Run(const std::string& source, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"run", source, "--out", folder_ / "out", "--last", "3"});
    return Alidade(options);
  }
  // Refused with one line that says `words`.
  static void ExpectRefused(const ProgramResult& result, int status, const std::string& words) {
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
  }

  TempFolder folder_;
};

TEST_F(BadFiles, PipesAreRefusedWhereverAFileIsNamed) {
  const std::string recording = Recording(), pipe = Pipe("pipe");
  ExpectRefused(Run(pipe), 3, "pipe");
  ExpectRefused(Run(recording, {"--config", pipe}), 3, "it is a pipe");
  ExpectRefused(Run(recording, {"--camera", pipe}), 3, "it is a pipe");
  ExpectRefused(Run(recording, {"--load", pipe}), 3, "it is a pipe");
  ExpectRefused(Run(recording, {"--detector", pipe}), 3, "pipe");
  ExpectRefused(Alidade({"info", pipe}), 3, "it is a pipe");
  ExpectRefused(Alidade({"export", pipe, "--to", "ply", folder_ / "a.ply"}), 3, "it is a pipe");
  ExpectRefused(Alidade({"evaluate", "ate", pipe, pipe}), 3, "it is a pipe");
}

TEST_F(BadFiles, EndlessDevicesAreRefusedUnread) {
  const std::string recording = Recording();
  for (const char* flag : {"--config", "--camera", "--load"})
    ExpectRefused(Run(recording, {flag, "/dev/zero"}), 3, "/dev/zero: it is a device");
}

TEST_F(BadFiles, PipesInsideARecordingAreRefusedOrSkipped) {
  const std::string recording = Recording();
  const std::string first = DataLines(recording + "/rgb.txt").at(0);
  const std::string image = recording + "/" + first.substr(first.find(' ') + 1);
  fs::rename(Pipe("image"), image);  // the image is gone, its place taken
  const ProgramResult run = Run(recording);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("frame 0 skipped: cannot read " + image + ": it is a pipe"));
  for (const char* name : {"camera.yaml", "depth.txt", "rgb.txt"}) {
    fs::rename(Pipe(name), recording + "/" + name);
    ExpectRefused(Run(recording), 3, std::string(name) + ": it is a pipe");
  }
}

TEST_F(BadFiles, PipesBesideATrajectoryDoNotStopItsEvaluation) {
  const std::string poses = folder_.Write("a/trajectory.txt",
                                          "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 1 0 0 0 0 1\n"
                                          "4 1 2 1 0 0 0 1\n");
  Pipe("a/stats.json");
  Pipe("a/rgb.txt");
  const ProgramResult result = Alidade({"evaluate", "ate", poses, poses});
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(BadFiles, LinksInACircleAreInputErrors) {
  const std::string recording = Recording();
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  const std::string circle = folder_ / "a", endless(5000, 'x');
  for (const std::string& path : {circle, endless}) {
    ExpectRefused(Run(path), 3, path.substr(0, 100));
    ExpectRefused(Run(recording, {"--config", path}), 3, path.substr(0, 100));
    ExpectRefused(Alidade({"info", path}), 3, path.substr(0, 100));
    ExpectRefused(Alidade({"evaluate", "ate", path, path}), 3, path.substr(0, 100));
    ExpectRefused(Alidade({"evaluate", "depth", path, path}), 3, path.substr(0, 100));
  }
}

TEST_F(BadFiles, YamlThatGrowsOrHoldsItselfIsRefused) {
  const std::string recording = Recording();
  const std::string itself = folder_.Write("itself.yaml", "tracker: &t\n  x: *t\n");
  std::string laughs = "a: &a {x: 1, y: 2, z: 3}\n";
  for (char c = 'b'; c <= 'i'; ++c) {
    const std::string before = std::string("*") + static_cast<char>(c - 1);
    laughs += std::string(1, c) + ": &" + c + " {a: " + before;
    for (const char* key : {"b", "c", "d", "e", "f", "g", "h", "i"})
      laughs += std::string(", ") + key + ": " + before;
    laughs += "}\n";
  }
  const std::string lol = folder_.Write("laughs.yaml", laughs);
  const std::string deep = folder_.Write("deep.yaml", "a: " + std::string(500000, '['));
  for (const std::string flag : {"--config", "--camera"}) {
    ExpectRefused(Run(recording, {flag, itself}), 3, "itself.yaml:1: anchors and aliases");
    ExpectRefused(Run(recording, {flag, lol}), 3, "laughs.yaml:1: anchors and aliases");
    ExpectRefused(Run(recording, {flag, deep}), 3, "deep.yaml:1: lists or maps are nested");
  }
  const std::string twice = folder_.Write("twice.yaml", "image_width: 200\nimage_width: 300\n");
  ExpectRefused(Run(recording, {"--config", twice}), 3, "twice.yaml:2: `image_width` is given");
}

TEST_F(BadFiles, ACameraLargerThanAnyIsRefused) {
  const std::string camera = folder_.Write(
      "large.yaml",
      "model: fisheye\nwidth: 20000\nheight: 20000\nfx: 9000\nfy: 9000\ncx: 9999\ncy: 9999\n");
  ExpectRefused(Run(Recording(), {"--camera", camera}), 3,
                "large.yaml:2: images of 20000x20000 are too large");
}

TEST_F(BadFiles, NumbersNobodyCanMeanAreUsageErrors) {
  const std::string recording = Recording();
  for (const char* threads : {"100000", "257", "-1"})
    ExpectRefused(Run(recording, {"--threads", threads}), 2, "--threads must be from 0");
  ExpectRefused(Alidade({"synth", "room", folder_ / "synth", "--threads", "100000"}), 2,
                "--threads must be from 0");
  ExpectRefused(Run(recording, {"--repeat", "2000000000"}), 2, "at most");
  for (const char* rate : {"1e-300", "-1", "nan", "inf", "0", "1e300"})
    ExpectRefused(Run(recording, {"--rate", rate}), 2, "--rate must be");
  ExpectRefused(Alidade({"run", "synth:room?width=1000000000"}), 2, "width");
  ExpectRefused(Alidade({"run", "synth:room?frames=1000000000"}), 2, "frames");
  ExpectRefused(Alidade({"run", "synth:room?noise=nan"}), 2, "noise");
  // The last frame there can be is one like any other.
  EXPECT_EQ(Alidade({"run", recording, "--out", folder_ / "out", "--first", "27", "--last",
                     "2147483647", "--quiet"})
                .status,
            0);
}

}  // namespace
}  // namespace alidade::bad_files_test
