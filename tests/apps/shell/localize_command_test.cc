// `alidade localize` with another camera than the map's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/rendered.h"

namespace alidade::localize_command_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr char kWalk[] = "synth:room?frames=60&seed=5&width=";

ProgramResult Into(const std::string& out, std::vector<std::string> words) {
  words.insert(words.end(), {"--out", out});
  return RunAlidade(words);
}

// Position of each frame, by its line.
std::vector<Eigen::Vector3d> Path(const std::string& out) {
  std::vector<Eigen::Vector3d> path;
  for (const std::string& line : DataLines(out + "/trajectory.txt")) {
    std::istringstream in(line);
    double time = 0;
    Eigen::Vector3d at;
    in >> time >> at.x() >> at.y() >> at.z();
    path.push_back(at);
  }
  return path;
}

TEST(LocalizeCommand, TakesAnyCameraInAMapWithDepth) {
  const TempFolder folder;
  const std::string map = folder / "map", rgbd = kWalk + std::string("320&height=240");
  ASSERT_EQ(Into(map, {"run", rgbd, "--quiet"}).status, 0);
  const std::vector<Eigen::Vector3d> walked = Path(map);
  for (const char* other : {"240&height=180&fov=70", "480&height=360&fov=50"}) {
    const std::string out = folder / "out";
    const ProgramResult result = Into(out, {"localize", std::string(kWalk) + other, "--sensor",
                                            "mono", "--map", map, "--overwrite"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("The map is of another camera (320x240"));
    const json stats = json::parse(ReadText(out + "/stats.json"), nullptr, false);
    EXPECT_EQ(stats["tracked"], 60) << other;
    const std::vector<Eigen::Vector3d> found = Path(out);
    ASSERT_EQ(found.size(), walked.size()) << other;
    for (size_t i = 0; i < found.size(); ++i) EXPECT_LT((found[i] - walked[i]).norm(), 0.04) << i;
  }
}

TEST(LocalizeCommand, TellsThatAMapGrowsByItsOwnCameraOnly) {
  const TempFolder folder;
  const std::string map = folder / "map";
  const std::string mine = std::string(kWalk) + "320&height=240";
  ASSERT_EQ(Into(map, {"run", mine, "--sensor", "mono", "--quiet"}).status, 0);
  const std::string other = std::string(kWalk) + "320&height=240&fov=70";
  const ProgramResult grown =
      Into(folder / "out", {"run", other, "--sensor", "mono", "--load", map, "--quiet"});
  EXPECT_EQ(grown.status, 3) << grown.err;
  EXPECT_THAT(grown.err, HasSubstr("another camera"));
  EXPECT_THAT(grown.err, HasSubstr("alidade localize"));
  const ProgramResult depth =
      Into(folder / "out", {"localize", mine, "--sensor", "rgbd", "--map", map, "--quiet"});
  EXPECT_EQ(depth.status, 3) << depth.err;
  EXPECT_THAT(depth.err, HasSubstr("--sensor mono"));
}

}  // namespace
}  // namespace alidade::localize_command_test
