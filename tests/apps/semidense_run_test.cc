// `alidade run --semidense` from end to end, on a small rendered recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "alidade/io/files/image_file.h"
#include "support/program.h"

namespace alidade::semidense_run_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

int CountOf(const std::string& text, const std::string& words) {
  int count = 0;
  for (size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    ++count;
  return count;
}

class SemiDenseRun : public testing::Test {
 protected:
  ProgramResult Run(const std::string& name, std::vector<std::string> more = {"--semidense"}) {
    std::vector<std::string> arguments = {"run", "synth:desk?frames=24&width=320&height=240",
                                          "--out", results_ / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunAlidade(arguments);
  }
  std::string Text(const std::string& name) { return ReadText(results_ / name); }

  TempFolder results_;
};

TEST_F(SemiDenseRun, LeavesDepthOfKeyFramesACloudAndPicturesOfIt) {
  const ProgramResult result = Run("out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(" semi-dense points"));
  // Each picture listed is there, named after a keyframe, and no other.
  std::set<std::string> keyframes, listed, found;
  std::istringstream lines(Text("out/keyframes.txt")), list(Text("out/depth.txt"));
  for (std::string line; std::getline(lines, line);)
    keyframes.insert(line.substr(0, line.find(' ')));
  int pixels = 0;
  for (std::string line; std::getline(list, line);) {
    if (line[0] == '#') continue;
    const std::string stamp = line.substr(0, line.find(' '));
    EXPECT_EQ(line, stamp + " depth/" + stamp + ".png");
    EXPECT_TRUE(keyframes.count(stamp)) << stamp;
    const cv::Mat depth = ReadDepth(results_ / ("out/depth/" + stamp + ".png"));
    EXPECT_EQ(depth.size(), cv::Size(320, 240));
    pixels += cv::countNonZero(depth);
    listed.insert(stamp + ".png");
  }
  for (const auto& entry : fs::directory_iterator(results_ / "out/depth"))
    found.insert(entry.path().filename().string());
  EXPECT_EQ(found, listed);
  EXPECT_GT(pixels, 1000);
  EXPECT_EQ(ReadImageColor(results_ / "out/semidense.png").size(), cv::Size(1200, 800));
  EXPECT_THAT(Text("out/semidense.ply").substr(0, 400),
              testing::AllOf(HasSubstr("property uchar red"), HasSubstr("property float sigma")));
  const auto stats = nlohmann::json::parse(Text("out/stats.json"));
  EXPECT_GE(stats["ms"]["semidense"]["count"], 1);
}

TEST_F(SemiDenseRun, ReportShowsItAndStillNeedsNothingElse) {
  ASSERT_EQ(Run("out").status, 0);
  const std::string report = Text("out/report.html");
  EXPECT_THAT(report, HasSubstr("<h2>Shape</h2>"));
  for (const char* view : {"from behind the first camera", "as the first camera looked",
                           "from its right", "from above"})
    EXPECT_EQ(CountOf(report, std::string("<img alt=\"") + view + "\""), 1) << view;
  EXPECT_EQ(CountOf(report, "src="),
            CountOf(report, "src=\"data:image/jpeg;base64,/9j/"));  // how a JPEG begins
  EXPECT_EQ(CountOf(report, "data-colored=\"1\""), 1);
  for (const char* outside : {"http:", "https:", "href=", "@import", "url("})
    EXPECT_EQ(CountOf(report, outside), 0) << outside;
}

TEST_F(SemiDenseRun, IsTheSameEveryTimeAndTheTrajectoryIsWhatItIsWithout) {
  ASSERT_EQ(Run("a").status, 0);
  ASSERT_EQ(Run("b", {"--semidense", "--threads", "1"}).status, 0);
  for (const char* file : {"semidense.ply", "semidense.png", "depth.txt", "map.alidade"})
    EXPECT_EQ(Text(std::string("a/") + file), Text(std::string("b/") + file)) << file;
  ASSERT_EQ(Run("c", {}).status, 0);
  EXPECT_EQ(Text("a/trajectory.txt"), Text("c/trajectory.txt"));
  EXPECT_EQ(Text("a/landmarks.ply"), Text("c/landmarks.ply"));
}

TEST_F(SemiDenseRun, OneWithoutRemovesWhatItLeft) {
  const auto is_there = [&](const std::string& name) {
    return fs::exists(results_ / ("out/" + name));
  };
  const std::vector<std::string> left = {"depth", "depth.txt", "semidense.ply", "semidense.png"};
  ASSERT_EQ(Run("out").status, 0);
  for (const std::string& name : left) EXPECT_TRUE(is_there(name)) << name;
  ASSERT_EQ(Run("out", {"--last", "5", "--overwrite"}).status, 0);
  for (const std::string& name : left) EXPECT_FALSE(is_there(name)) << name;
  EXPECT_THAT(Text("out/report.html"), Not(HasSubstr("<h2>Shape</h2>")));
}

TEST_F(SemiDenseRun, SaysWhenThereIsNoShape) {
  const ProgramResult result = Run("out", {"--semidense", "--last", "1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(", no semi-dense depth"));
  EXPECT_FALSE(fs::exists(results_ / "out/depth"));
  EXPECT_FALSE(fs::exists(results_ / "out/semidense.ply"));
}

TEST_F(SemiDenseRun, VoxelsThinTheCloudOut) {
  const auto points = [&](const std::string& voxel) {
    EXPECT_EQ(Run("out", {"--semidense", "--set", "semidense.voxel=" + voxel}).status, 0);
    const std::string ply = Text("out/semidense.ply");
    return std::stoi(ply.substr(ply.find("vertex ") + 7));
  };
  const int all = points("0"), fine = points("0.005"), coarse = points("0.05");
  EXPECT_LT(fine, all);
  EXPECT_LT(coarse, fine / 4);
}

}  // namespace
}  // namespace alidade::semidense_run_test
