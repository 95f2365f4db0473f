// alidade mesh and alidade grid as a user runs them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/program.h"
#include "support/rendered.h"

namespace alidade::surface_command_test {
namespace {

std::string Recording() {
  return Rendered({"room", "--frames", "60", "--width", "320", "--height", "240"});
}

// A result of the recording, made once for all tests of this process.
std::string Result(const TempFolder& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"run", Recording(), "--out", folder / "result", "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramResult run = RunAlidade(words);
  EXPECT_EQ(run.status, 0) << run.err;
  return folder / "result";
}

// Reads map.yaml as map_server does, and prints size, and numbers of free, occupied, unknown cells.
constexpr char kReader[] = R"(
import sys, yaml, os
path = sys.argv[1]
y = yaml.safe_load(open(path))
assert y['mode'] == 'trinary' and y['negate'] == 0 and len(y['origin']) == 3, y
data = open(os.path.join(os.path.dirname(path), y['image']), 'rb').read()
magic, size, most, pixels = data.split(b'\n', 3)
w, h = map(int, size.split())
assert magic == b'P5' and most == b'255' and len(pixels) == w * h
n = [0, 0, 0]
for p in pixels:
    q = (255 - p) / 255
    n[1 if q > y['occupied_thresh'] else 0 if q < y['free_thresh'] else 2] += 1
print(y['resolution'], *n)
)";

TEST(SurfaceCommands, GridIsReadByAnotherProgram) {
  if (std::system("python3 -c 'import yaml' 2>/dev/null") != 0) GTEST_SKIP() << "no PyYAML here";
  const TempFolder folder;
  const std::string result = Result(folder);
  const ProgramResult grid = RunAlidade({"grid", result, "--out", folder / "map"});
  ASSERT_EQ(grid.status, 0) << grid.err;
  EXPECT_NE(grid.out.find("sensor depth"), std::string::npos) << grid.out;
  const ProgramResult read = RunProgram("/usr/bin/python3", {"-c", kReader, folder / "map.yaml"});
  ASSERT_EQ(read.status, 0) << read.err;
  double cell = 0;
  int free = 0, occupied = 0, unknown = 0;
  std::istringstream(read.out) >> cell >> free >> occupied >> unknown;
  EXPECT_EQ(cell, 0.05);
  EXPECT_GT(free, 200);
  EXPECT_GT(occupied, 50);
  EXPECT_GT(unknown, 50);
}

TEST(SurfaceCommands, FilesOfTheResultAreItsOwn) {
  const TempFolder folder;
  const std::string result = Result(folder);
  for (int time = 0; time < 2; ++time) {  // may be made again
    const ProgramResult mesh = RunAlidade({"mesh", result});
    ASSERT_EQ(mesh.status, 0) << mesh.err;
    ASSERT_EQ(RunAlidade({"grid", result}).status, 0);
  }
  for (const char* name : {"mesh.ply", "mesh.glb", "map.pgm", "map.yaml"})
    EXPECT_TRUE(std::filesystem::exists(result + "/" + name)) << name;
  const std::string report = ReadText(result + "/report.html");
  for (const char* heading : {"<h2>Mesh</h2>", "<h2>Floor grid</h2>"}) {
    const size_t first = report.find(heading);
    ASSERT_NE(first, std::string::npos) << heading;
    EXPECT_EQ(report.find(heading, first + 1), std::string::npos) << heading;
  }
  // The next run of the same recording takes them away: they are of another map.
  Result(folder);
  EXPECT_FALSE(std::filesystem::exists(result + "/mesh.ply"));
  EXPECT_FALSE(std::filesystem::exists(result + "/map.yaml"));
}

TEST(SurfaceCommands, FilesOfOthersAreKept) {
  const TempFolder folder;
  const std::string result = Result(folder);
  std::ofstream(result + "/mesh.glb") << "mine";
  const ProgramResult mesh = RunAlidade({"mesh", result});
  EXPECT_EQ(mesh.status, 2);
  EXPECT_NE(mesh.err.find("was not written by alidade"), std::string::npos) << mesh.err;
  EXPECT_EQ(ReadText(result + "/mesh.glb"), "mine");
  EXPECT_EQ(RunAlidade({"mesh", result, "--out", result + "/report"}).status, 0);
  EXPECT_EQ(RunAlidade({"mesh", result, "--out", result + "/landmarks.ply"}).status, 2);
}

TEST(SurfaceCommands, OneCameraNeedsSemiDenseDepthAndHasNoMeters) {
  const TempFolder folder;
  const std::string bare = Result(folder, {"--sensor", "mono"});
  ProgramResult grid = RunAlidade({"grid", bare});
  EXPECT_EQ(grid.status, 3);
  EXPECT_NE(grid.err.find("--semidense"), std::string::npos) << grid.err;
  EXPECT_EQ(RunAlidade({"mesh", bare}).status, 2);
  const std::string dense = Result(folder, {"--sensor", "mono", "--semidense"});
  grid = RunAlidade({"grid", dense, "--cell", "0.05", "--camera-height", "0.5"});
  ASSERT_EQ(grid.status, 0) << grid.err;
  EXPECT_NE(ReadText(dense + "/map.yaml").find("NOT METERS"), std::string::npos);
}

TEST(SurfaceCommands, RecordingThatIsGoneIsNamed) {
  const TempFolder folder;
  const std::string result = Result(folder);
  const ProgramResult mesh = RunAlidade({"mesh", result, "--source", folder / "nowhere"});
  EXPECT_EQ(mesh.status, 3);
  EXPECT_NE(mesh.err.find("nowhere"), std::string::npos) << mesh.err;
}

}  // namespace
}  // namespace alidade::surface_command_test
