// Every scene has the intended difficulty and length for several seeds.
#include "alidade/synth/scenes/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/synth/recording.h"
#include "alidade/synth/statistics.h"

namespace alidade::scenes_test {
namespace {

class Scenes : public testing::TestWithParam<std::string> {};

// FAST-9 corners (Rosten & Drummond 2006) without non-maximum suppression; counts the cells of an 8
// × 6 grid that contain any.
struct Corners {
  int count = 0, cells = 0;
};
Corners FindCorners(const cv::Mat& image, int threshold) {
  constexpr int kRing[16][2] = {{0, -3}, {1, -3},  {2, -2},  {3, -1}, {3, 0},  {3, 1},
                                {2, 2},  {1, 3},   {0, 3},   {-1, 3}, {-2, 2}, {-3, 1},
                                {-3, 0}, {-3, -1}, {-2, -2}, {-1, -3}};
  Corners corners;
  bool cell[48] = {};
  cv::Mat1b found(image.size(), uint8_t{0});
  for (int y = 3; y < image.rows - 3; ++y) {
    for (int x = 3; x < image.cols - 3; ++x) {
      const int centre = image.at<uint8_t>(y, x);
      int brighter = 0, darker = 0;
      bool corner = false;
      for (int i = 0; i < 25 && !corner; ++i) {
        const int value = image.at<uint8_t>(y + kRing[i % 16][1], x + kRing[i % 16][0]);
        brighter = value > centre + threshold ? brighter + 1 : 0;
        darker = value < centre - threshold ? darker + 1 : 0;
        corner = brighter >= 9 || darker >= 9;
      }
      // Count connected neighbors once.
      if (!corner || found(y - 1, x) || found(y - 1, x - 1) || found(y - 1, x + 1) ||
          found(y, x - 1)) {
        found(y, x) = corner;
        continue;
      }
      found(y, x) = 1;
      ++corners.count;
      cell[y * 6 / image.rows * 8 + x * 8 / image.cols] = true;
    }
  }
  corners.cells = static_cast<int>(std::count(cell, cell + 48, true));
  return corners;
}

// Intended properties of a scene.
struct Meant {
  double turn = 20;               // median, degrees per second, minimum
  double slow = 0.3, fast = 0.9;  // range of the median, meters per second
  double fastest = 1.6;           // maximum, meters per second
  double length = 5;              // of the path, meters, minimum
  double close = 0.6;             // distance between end and start, meters, maximum
  int poor = 0, rich = 0;         // of 12 frames, number with few corners: minimum and maximum
  double missing = 0.45;          // share of pixels without depth, maximum
  bool open = false;              // has a sky
};
Meant MeantOf(const std::string& scene) {
  Meant meant;
  if (scene == "room") meant.length = 12;
  if (scene == "loop") meant.length = 40;
  if (scene == "table") meant = {10, 0.25, 0.9, 1.6, 3, 0.6, 10, 12, 0.45, false};
  if (scene == "blank") meant = {20, 0.25, 0.9, 1.6, 4, 0.6, 2, 6, 0.45, false};
  if (scene == "hall") meant = {14, 0.3, 0.9, 1.6, 12, 0.6, 3, 7, 0.45, false};
  if (scene == "road") meant = {1, 13, 15, 15, 800, 16, 6, 12, 0.95, true};
  if (scene == "street") meant = {2, 7, 10, 10.8, 300, 12, 0, 2, 0.95, true};
  return meant;
}

TEST_P(Scenes, AreWalkedAtTheSpeedTheyAreMeantToBeWithManyTurns) {
  const Meant meant = MeantOf(GetParam());
  for (const uint64_t seed : {1, 2, 3}) {
    // Poses do not require painting.
    SceneBuilder builder(seed);
    const Layout layout = LayOut(GetParam(), builder);
    const CameraPath path(layout.knots, layout.period, layout.turns, layout.shake, seed);
    const double fps = SynthSettings().fps;
    const int frames = SceneFrames(GetParam());
    std::vector<Se3> poses;
    StatisticsCollector collector(fps);
    double fastest = 0, sharpest = 0;
    for (int i = 0; i < frames; ++i) {
      poses.push_back(path.At(i / fps));
      collector.AddPose(poses.back());
      if (i == 0) continue;
      fastest = std::max(fastest, (poses[i].t - poses[i - 1].t).norm() * fps);
      sharpest =
          std::max(sharpest, RotationAngle(poses[i], poses[i - 1]) * fps * 180 / std::numbers::pi);
    }
    const SynthStatistics found = collector.Result();
    EXPECT_GE(found.median_turn, meant.turn) << seed;
    EXPECT_LT(sharpest, 160) << seed;
    EXPECT_GT(found.median_speed, meant.slow) << seed;
    EXPECT_LT(found.median_speed, meant.fast) << seed;
    EXPECT_LT(fastest, meant.fastest) << seed;
    EXPECT_GE(found.path_length, meant.length) << seed;
    // Starts with a translation, not a pure rotation, so that a monocular map can be initialized.
    EXPECT_GT((poses[30].t - poses[0].t).norm(), 0.15) << seed;
    // Returns to its start.
    double nearest = 1e9;
    for (int i = frames * 3 / 4; i < frames; ++i)
      nearest = std::min(nearest, (poses[i].t - poses[0].t).norm());
    EXPECT_LT(nearest, meant.close) << seed;
  }
}

TEST_P(Scenes, HaveCornersWhereTheyAreMeantToYetMuchThatIsPlain) {
  const Meant meant = MeantOf(GetParam());
  SynthSettings settings;
  settings.scene = GetParam();
  settings.frames = SceneFrames(settings.scene);
  const SynthRecording recording(settings);
  StatisticsCollector collector(settings.fps);
  constexpr int kLooks = 12;
  int poor = 0;
  std::string seen;
  for (int i = 0; i < kLooks; ++i) {
    const int number = settings.frames * i / kLooks;
    const RenderedFrame frame = recording.Render(number);
    collector.AddFrame(frame);
    const Corners corners = FindCorners(frame.image, 20);
    const bool enough = corners.count >= 300 && corners.cells >= 24;
    if (!enough)
      seen += "frame " + std::to_string(number) + ": " + std::to_string(corners.count) +
              " corners in " + std::to_string(corners.cells) + " cells; ";
    poor += !enough;
    // The path does not pass through objects, and the scene is closed except for single pixels at
    // seams.
    double nearest = 0;
    const cv::Mat there = frame.depth_exact > 0;
    cv::minMaxLoc(frame.depth_exact, &nearest, nullptr, nullptr, nullptr, there);
    EXPECT_GT(nearest, 0.25) << "frame " << number;
    if (!meant.open) {
      EXPECT_GE(cv::countNonZero(there), frame.image.rows * frame.image.cols - 2) << number;
    }
  }
  EXPECT_GE(poor, meant.poor) << seen;
  EXPECT_LE(poor, meant.rich) << seen;
  const SynthStatistics found = collector.Result();
  EXPECT_GE(found.plain_share, 0.2);
  EXPECT_LT(found.missing_depth, meant.missing);
}

INSTANTIATE_TEST_SUITE_P(All, Scenes, testing::ValuesIn(SceneNames()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace alidade::scenes_test
