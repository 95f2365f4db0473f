// A standing camera before which something large passes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "alidade/io/files/image_file.h"
#include "support/rendered.h"
#include "support/texture.h"

namespace alidade::passing_object_test {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 100, kWidth = 640, kHeight = 480;
constexpr int kWall = 480, kBegin = 25, kEnd = 85;  // pixels; frames in which a part of it is seen

// The images of a folder in order of time.
std::vector<std::string> ImagesIn(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

// A wall 1.2 m away passes from left to right in two seconds.
void LetAWallPass(const std::string& room) {
  cv::Mat texture;
  cv::cvtColor(MakeTexture(kWall, kHeight, 6), texture, cv::COLOR_GRAY2BGR);
  const std::vector<std::string> images = ImagesIn(room + "/rgb"),
                                 depths = ImagesIn(room + "/depth");
  for (int i = kBegin; i < kEnd; ++i) {
    const int left = (kWidth + kWall) * (i - kBegin) / (kEnd - kBegin) - kWall;
    const int begin = std::max(0, left), end = std::min(kWidth, left + kWall);
    if (begin >= end) continue;
    const cv::Rect place(begin, 0, end - begin, kHeight);
    cv::Mat image = ReadImageColor(images[i]), depth = ReadDepth(depths[i]);
    texture(cv::Rect(begin - left, 0, end - begin, kHeight)).copyTo(image(place));
    depth(place).setTo(1.2 * 5000);
    WriteImage(images[i], image);
    WriteImage(depths[i], depth);
  }
}

TEST(PassingObject, DoesNotMoveACameraThatStands) {
  const TempFolder folder;
  const std::string room = CopyOf(
      Rendered({"room", "--path", "still", "--frames", std::to_string(kFrames), "--seed", "3"}),
      folder);
  LetAWallPass(room);
  const std::string out = folder / "out";
  const ProgramResult result = RunAlidade({"run", room, "--sensor", "rgbd", "--out", out});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("left out of the map"));
  const std::vector<std::string> poses = DataLines(out + "/trajectory.txt");
  // While the wall covers all but some tens of landmarks, there may be no pose.
  EXPECT_GE(poses.size(), kFrames * 3u / 4);
  for (const std::string& pose : poses) {
    std::istringstream line(pose);
    double time = 0;
    Eigen::Vector3d t;
    line >> time >> t.x() >> t.y() >> t.z();
    EXPECT_LT(t.norm(), 0.02) << time;
  }
}

}  // namespace
}  // namespace alidade::passing_object_test
