// SLAM among moving people in rendered rooms: what enters the map, and results of a detector that
// must do no harm.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "alidade/base/parallel.h"
#include "alidade/slam.h"
#include "support/check_map.h"
#include "support/expect_error.h"
#include "support/scripted_detector.h"
#include "support/walked_room.h"

namespace alidade::dynamics_test {
namespace {

constexpr int kAll = 80;        // frames; the first may have too few keypoints with depth
constexpr double kNear = 0.06;  // meters; images have 320 × 240 pixels and show people

const WalkedRoom& Room() {
  static const WalkedRoom room = WalkRoom({.actors = 2, .frames = kAll, .stereo = true, .seed = 6});
  return room;
}

SlamSettings Settings(DynamicsMode mode, Sensor sensor = Sensor::kRgbd) {
  SlamSettings settings;
  settings.sensor = sensor;
  settings.dynamics.mode = mode;
  settings.tracker.extractor.features = 600;  // for a small image
  settings.tracker.match_scale = settings.mapper.match_scale = settings.start.match_scale = 0.8;
  return settings;
}

// The number of an image's frame; -1: unknown.
int NumberOf(const cv::Mat& image) {
  for (size_t i = 0; i < Room().frames.size(); ++i) {
    const cv::Mat& known = Room().frames[i].image;
    if (image.size() == known.size() && image.type() == known.type() &&
        cv::countNonZero(image != known) == 0)
      return static_cast<int>(i);
  }
  return -1;
}

// Boxes around the true masks of people, as from a good detector.
std::vector<Detection> TrueBoxes(const cv::Mat& image) {
  const int number = NumberOf(image);
  std::vector<Detection> found;
  if (number < 0) return found;
  cv::Mat labels, stats, centres;
  const int count =
      cv::connectedComponentsWithStats(Room().frames[number].mask, labels, stats, centres);
  for (int i = 1; i < count; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) < 60) continue;
    found.push_back({0, 0.9f,
                     cv::Rect2f(static_cast<float>(stats.at<int>(i, cv::CC_STAT_LEFT)),
                                static_cast<float>(stats.at<int>(i, cv::CC_STAT_TOP)),
                                static_cast<float>(stats.at<int>(i, cv::CC_STAT_WIDTH)),
                                static_cast<float>(stats.at<int>(i, cv::CC_STAT_HEIGHT)))});
  }
  return found;
}

std::shared_ptr<Detector> Good() { return std::make_shared<ScriptedDetector>(TrueBoxes); }

struct Played {
  int tracked = 0, tracked_at_end = 0;  // frames; at the end: of the last ten
  double worst = 0, worst_at_end = 0;   // largest position error, meters
  int keypoints = 0, on_people = 0;     // keypoints of landmarks in keyframes
  std::string map;                      // bytes
};

Played Play(const SlamSettings& settings, std::shared_ptr<Detector> detector = nullptr) {
  Camera camera = Room().camera;
  if (settings.sensor != Sensor::kStereo) camera.baseline = 0;
  Slam slam(camera, settings, std::move(detector));
  for (const RenderedFrame& frame : Room().frames) {
    FrameInput input;
    input.time = frame.time;
    input.image = frame.image;
    if (settings.sensor == Sensor::kStereo) input.right = frame.right;
    if (settings.sensor == Sensor::kRgbd) input.depth = frame.depth;
    slam.Track(input);
    const cv::Mat mask = slam.MoverMask();
    if (settings.dynamics.mode == DynamicsMode::kOff) {
      EXPECT_TRUE(mask.empty());
    } else {
      EXPECT_EQ(mask.size(), frame.image.size());
      EXPECT_EQ(mask.type(), CV_8U);
    }
    for (const FeatureUse& feature : slam.Features())
      EXPECT_TRUE(feature.static_probability >= 0 && feature.static_probability <= 1);
  }
  slam.Finish();
  Played played;
  int first = -1;
  for (const FramePose& pose : slam.Trajectory()) {
    if (!pose.tracked) continue;
    if (first < 0) first = pose.index;
    const Se3 truth = Room().T_camera_world[first] * Room().T_camera_world[pose.index].Inverse();
    const double off = (pose.T_world_camera.t - truth.t).norm();
    ++played.tracked;
    played.worst = std::max(played.worst, off);
    if (pose.index + 10 < kAll) continue;
    ++played.tracked_at_end;
    played.worst_at_end = std::max(played.worst_at_end, off);
  }
  const MapSnapshot map = slam.Snapshot();
  ExpectConsistent(map);
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    cv::Mat people;  // without the outline, where a keypoint may be on either side
    cv::erode(Room().frames[keyframe.frame->number].mask, people, cv::Mat::ones(5, 5, CV_8U));
    for (size_t k = 0; k < keyframe.landmarks.size(); ++k) {
      if (!keyframe.landmarks[k].valid()) continue;
      const Keypoint& keypoint = keyframe.frame->keypoints[k];
      ++played.keypoints;
      played.on_people += people.at<uint8_t>(static_cast<int>(std::lround(keypoint.raw_y)),
                                             static_cast<int>(std::lround(keypoint.raw_x))) > 0;
    }
  }
  played.map = slam.SaveMap();
  return played;
}

double ShareOnPeople(const Played& played) {
  return static_cast<double>(played.on_people) / std::max(1, played.keypoints);
}

TEST(DynamicSlam, TheMapHoldsFewPeople) {
  const Played off = Play(Settings(DynamicsMode::kOff));
  ASSERT_GT(ShareOnPeople(off), 0.015);  // without dynamics the people do harm
  for (DynamicsMode mode : {DynamicsMode::kGeometry, DynamicsMode::kFull}) {
    const Played on = Play(Settings(mode), Good());
    EXPECT_GE(on.tracked, kAll - 1) << NameOf(mode);
    EXPECT_LT(on.worst, kNear) << NameOf(mode);
    EXPECT_LT(ShareOnPeople(on), 0.5 * ShareOnPeople(off)) << NameOf(mode);
  }
}

TEST(DynamicSlam, IsTheSameWithOneAndTwoThreadsRunAfterRun) {
  for (Sensor sensor : {Sensor::kRgbd, Sensor::kStereo, Sensor::kMono}) {
    std::vector<std::string> maps;
    for (int threads : {1, 2, 2}) {
      SetThreadCount(threads);
      maps.push_back(Play(Settings(DynamicsMode::kFull, sensor), Good()).map);
    }
    SetThreadCount(0);
    EXPECT_TRUE(maps[1] == maps[0]) << NameOf(sensor);
    EXPECT_TRUE(maps[2] == maps[0]) << NameOf(sensor);
  }
}

TEST(DynamicSlam, FullNeedsADetectorAndTheOthersDoNot) {
  const std::string message = MessageOf(
      ErrorKind::kUsage, [] { const Slam slam(Room().camera, Settings(DynamicsMode::kFull)); });
  EXPECT_THAT(message, testing::HasSubstr("detector"));
  const Slam geometry(Room().camera, Settings(DynamicsMode::kGeometry));
  const Slam off(Room().camera, Settings(DynamicsMode::kOff));
}

TEST(DynamicSlam, TheDetectorIsNotAskedWithGeometryAlone) {
  const auto never = std::make_shared<ScriptedDetector>(
      [](const cv::Mat&) -> std::vector<Detection> { throw std::runtime_error("asked"); });
  const WarningCatcher warnings;
  Play(Settings(DynamicsMode::kGeometry), never);
  EXPECT_EQ(warnings.text(), "");
}

TEST(DynamicSlam, GoesOnWithGeometryWhenTheDetectorFails) {
  int asked = 0;
  const auto failing = std::make_shared<ScriptedDetector>([&](const cv::Mat& image) {
    if (++asked == 4) ThrowInput("the network's answers are not numbers");
    return TrueBoxes(image);
  });
  const WarningCatcher warnings;
  const Played played = Play(Settings(DynamicsMode::kFull), failing);
  EXPECT_EQ(asked, 4);
  EXPECT_EQ(std::count(warnings.text().begin(), warnings.text().end(), '\n'), 1) << warnings.text();
  EXPECT_THAT(warnings.text(), testing::HasSubstr("geometry"));
  EXPECT_GE(played.tracked, kAll - 1);
  EXPECT_LT(played.worst, kNear);
}

// Reports a person at `box` in the frames `begin` to `end`.
std::shared_ptr<Detector> Says(const cv::Rect2f& box, int begin, int end) {
  return std::make_shared<ScriptedDetector>([=](const cv::Mat& image) {
    const int number = NumberOf(image);
    if (number < begin || number > end) return std::vector<Detection>();
    return std::vector<Detection>{{0, 0.9f, box}};
  });
}

SlamSettings AtOnce(Sensor sensor) {
  SlamSettings settings = Settings(DynamicsMode::kFull, sensor);
  settings.dynamics.detector_every_frames = 1;
  settings.dynamics.detector_latency_frames = 0;
  settings.dynamics.bridge_seconds = 0.1;
  return settings;
}

TEST(DynamicSlam, APersonOverHalfThePictureIsOfNoHarm) {
  for (Sensor sensor : {Sensor::kRgbd, Sensor::kStereo}) {
    const Played played = Play(AtOnce(sensor), Says({0, 0, 160, 240}, 0, kAll));
    EXPECT_EQ(played.tracked_at_end, 10) << NameOf(sensor);
    EXPECT_LT(played.worst, kNear) << NameOf(sensor);
  }
}

TEST(DynamicSlam, TrackingComesBackAfterTheWholePictureWasAPerson) {
  for (Sensor sensor : {Sensor::kRgbd, Sensor::kStereo}) {
    for (bool foreground : {true, false}) {  // false: every feature is left out
      SlamSettings settings = AtOnce(sensor);
      settings.dynamics.foreground = foreground;
      const Played played = Play(settings, Says({0, 0, 320, 240}, 30, 39));
      EXPECT_EQ(played.tracked_at_end, 10) << NameOf(sensor) << foreground;
      EXPECT_LT(played.worst_at_end, kNear) << NameOf(sensor) << foreground;
    }
  }
}

TEST(DynamicSlam, APersonOverTheWholePictureAllTheTimeIsNoCrash) {
  for (Sensor sensor : {Sensor::kRgbd, Sensor::kStereo, Sensor::kMono}) {
    SlamSettings settings = AtOnce(sensor);
    settings.dynamics.foreground = false;
    Play(settings, Says({0, 0, 320, 240}, 0, kAll));
  }
}

TEST(DynamicSlam, DetectionsNobodyCanMeanAreOfNoHarm) {
  const float nan = std::nanf("");
  int asked = 0;
  const auto odd = std::make_shared<ScriptedDetector>([&](const cv::Mat&) {
    ++asked;
    std::vector<Detection> found = {{-1, 0.9f, {10, 10, 50, 50}},
                                    {77, 0.9f, {10, 10, 50, 50}},
                                    {0, 0.9f, {100, 100, 0, 0}},
                                    {0, 0.9f, {319, 239, 1, 1}}};
    if (asked % 2 == 0) found.push_back({0, nan, {200, 100, 30, 60}});
    return found;
  });
  const Played played = Play(Settings(DynamicsMode::kFull), odd);
  EXPECT_GT(asked, 5);
  EXPECT_GE(played.tracked, kAll - 1);
  EXPECT_LT(played.worst, kNear);
}

TEST(DynamicSlam, TheDetectorBesideItNeedNotKeepUp) {
  SlamSettings settings = Settings(DynamicsMode::kFull);
  settings.threaded = true;
  const Played played = Play(settings, Good());
  EXPECT_GE(played.tracked, kAll - 3);
  EXPECT_LT(played.worst, 0.1);
}

TEST(DynamicSlam, TimesAreToldForEachFrame) {
  Slam slam(Room().camera, Settings(DynamicsMode::kFull), Good());
  for (int i = 0; i < 14; ++i) {
    const RenderedFrame& frame = Room().frames[i];
    slam.Track({frame.time, frame.image, {}, frame.depth});
  }
  EXPECT_EQ(slam.Times().dynamics.size(), 14u);
  EXPECT_GT(slam.Times().detect.size(), 0u);
  Slam off(Room().camera, Settings(DynamicsMode::kOff));
  off.Track({0, Room().frames[0].image, {}, Room().frames[0].depth});
  EXPECT_TRUE(off.Times().dynamics.empty());
  EXPECT_TRUE(off.Times().detect.empty());
}

}  // namespace
}  // namespace alidade::dynamics_test
