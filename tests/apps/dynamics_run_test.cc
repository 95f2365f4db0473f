// `alidade run --dynamics` from end to end on a room in which people walk about: masks, figures and
// poses.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/io/files/image_file.h"
#include "support/rendered.h"

namespace alidade::dynamics_run_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kFrames = 80;  // who walks where depends on it: here nobody stands about for long

class DynamicsRun : public testing::Test {
 protected:
  static std::string Recording() {
    return Rendered({"room", "--frames", std::to_string(kFrames), "--actors", "2", "--width", "320",
                     "--height", "240", "--seed", "6"});
  }
  std::string Run(const std::string& name, std::vector<std::string> options) {
    const std::string out = folder_ / name;
    std::vector<std::string> words = {"run",     Recording(), "--sensor", "rgbd",
                                      "--quiet", "--out",     out};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramResult result = RunAlidade(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return out;
  }
  static json Stats(const std::string& out) {
    return json::parse(ReadText(out + "/stats.json"), nullptr, false);
  }
  // Second words of the lines of a list: stamp, file.
  static std::vector<std::pair<std::string, std::string>> List(const std::string& path) {
    std::vector<std::pair<std::string, std::string>> list;
    for (const std::string& line : DataLines(path)) {
      std::istringstream words(line);
      std::pair<std::string, std::string> entry;
      words >> entry.first >> entry.second;
      list.push_back(entry);
    }
    return list;
  }
  TempFolder folder_;
};

TEST_F(DynamicsRun, GeometryLeavesAMaskForEveryFrameThatIsOnThePeople) {
  const std::string out = Run("geometry", {"--dynamics", "geometry", "--write-masks"});
  const auto masks = List(out + "/mask.txt"), truth = List(Recording() + "/mask.txt");
  ASSERT_EQ(masks.size(), static_cast<size_t>(kFrames));
  ASSERT_EQ(truth.size(), masks.size());
  double overlap = 0;
  int looked = 0;
  for (size_t i = 0; i < masks.size(); ++i) {
    EXPECT_EQ(masks[i].first, truth[i].first);
    const cv::Mat mask = ReadImageGray(out + "/" + masks[i].second);
    const cv::Mat people = ReadImageGray(Recording() + "/" + truth[i].second);
    ASSERT_EQ(mask.size(), people.size());
    ASSERT_EQ(cv::countNonZero((mask != 0) & (mask != 255)), 0) << masks[i].second;
    if (i < 40) continue;  // who they are is learnt first
    const int either = cv::countNonZero(mask | people);
    if (either == 0) continue;
    overlap += static_cast<double>(cv::countNonZero(mask & people)) / either;
    ++looked;
  }
  ASSERT_GT(looked, 20);
  // Cells are 4 pixels wide and people some 40: outlines alone cost a fifth.
  EXPECT_GT(overlap / looked, 0.55);
}

TEST_F(DynamicsRun, StatsTellWhatItCostAndWhatWasOn) {
  const json stats = Stats(Run("geometry", {"--dynamics", "geometry"}));
  EXPECT_FALSE(stats["ms"]["dynamics"].is_null());
  EXPECT_EQ(stats["ms"]["dynamics"]["count"], kFrames);
  EXPECT_EQ(stats["settings"]["dynamics.mode"], "geometry");
  EXPECT_GE(stats["tracked"], kFrames - 1);  // the first may have too few corners with depth
  const json off = Stats(Run("off", {"--dynamics", "off"}));
  EXPECT_TRUE(off["ms"]["dynamics"].is_null());
  EXPECT_EQ(off["settings"]["dynamics.mode"], "off");
  EXPECT_EQ(Stats(Run("as it comes", {}))["settings"]["dynamics.mode"], "auto");
}

TEST_F(DynamicsRun, PosesStayAtTheTruthAmongPeople) {
  const std::string out = Run("geometry", {"--dynamics", "geometry"});
  const ProgramResult result = RunAlidade({"evaluate", "ate", Recording(), out, "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_LT(json::parse(result.out).value("rmse", 1e9), 0.04);  // 320 × 240 pixels
}

TEST_F(DynamicsRun, AMapThatBeganOnAPersonIsBegunAgain) {
  // Someone walks ahead of the camera, large and full of corners.
  const std::string out = folder_ / "again";
  const ProgramResult run =
      RunAlidade({"run", "synth:room?actors=3&seed=4", "--last", "79", "--sensor", "mono",
                  "--dynamics", "geometry", "--quiet", "--out", out});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_GT(DataLines(out + "/trajectory.txt").size(), 40u);
  const ProgramResult result = RunAlidade({"evaluate", "ate", out + "/groundtruth.txt",
                                           out + "/trajectory.txt", "--align", "sim3", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_LT(json::parse(result.out).value("rmse", 1e9), 0.06);  // of the person: 0.25
}

// Off by 26 cm when all is taken to stand still, by 4.5 in the empty kitchen.
TEST_F(DynamicsRun, PeopleWhoFillThePictureAreLeftOutUnasked) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const std::string walk = DataFolder() + "/kitchen_walk", out = folder_ / "walk";
  const ProgramResult run = RunAlidade({"run", walk, "--sensor", "rgbd", "--out", out});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("moving objects are left out"), std::string::npos) << run.err;
  const ProgramResult result = RunAlidade({"evaluate", "ate", walk, out, "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_LT(json::parse(result.out).value("rmse", 1e9), 0.08);
}

TEST_F(DynamicsRun, IsTheSameTwiceWithAnyNumberOfThreads) {
  const std::string one = Run("one", {"--dynamics", "geometry", "--write-masks", "--threads", "1"});
  const std::string two = Run("two", {"--dynamics", "geometry", "--write-masks", "--threads", "2"});
  for (const char* name : {"/trajectory.txt", "/keyframes.txt", "/landmarks.ply", "/mask.txt"})
    EXPECT_EQ(ReadText(one + name), ReadText(two + name)) << name;
  for (const auto& [stamp, file] : List(one + "/mask.txt"))
    ASSERT_EQ(ReadText(one + "/" + file), ReadText(two + "/" + file)) << file;
}

}  // namespace
}  // namespace alidade::dynamics_run_test
