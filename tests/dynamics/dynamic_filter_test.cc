// The complete filter on rendered rooms with exact poses; the excluded parts are compared with the
// true masks of people.
#include "alidade/dynamics/dynamic_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "support/texture.h"
#include "support/walked_room.h"

namespace alidade::dynamic_filter_test {
namespace {

const std::vector<std::string> kNames = {"person", "chair"};

struct Senses {
  bool depth = true, right = false, pose = true;
};

// One filter with its inputs.
class Watcher {
 public:
  Watcher(const Camera& camera, const DynamicsSettings& settings, const Senses& senses = {})
      : camera_(camera), senses_(senses), filter_(camera, settings, kNames) {}

  void See(int number, const RenderedFrame& seen, const Se3& T_camera_world,
           const std::optional<FrameDetections>& arrived = {}) {
    filter_.Advance({number, seen.time, seen.image, senses_.depth ? seen.depth : cv::Mat(),
                     senses_.right ? seen.right : cv::Mat()},
                    arrived);
    frame_ = FeaturesOf(seen);
    frame_.number = number;
    frame_.time = seen.time;
    const PoseGuess guess{T_camera_world, 0.4};
    filter_.Judge(frame_, senses_.pose ? &guess : nullptr);
    filter_.Remember(frame_, senses_.pose ? &T_camera_world : nullptr, {});
  }
  cv::Mat Mask() const { return filter_.Mask(); }
  const Frame& frame() const { return frame_; }
  const DynamicFilter& filter() const { return filter_; }

 private:
  // OpenCV's corners, with the depth of the image.
  Frame FeaturesOf(const RenderedFrame& seen) const {
    Frame frame;
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(seen.image, corners, 600, 0.01, 6);
    for (const cv::Point2f& corner : corners) {
      Keypoint keypoint;
      keypoint.x = keypoint.raw_x = corner.x;
      keypoint.y = keypoint.raw_y = corner.y;
      const uint16_t reading =
          seen.depth.at<uint16_t>(static_cast<int>(corner.y), static_cast<int>(corner.x));
      if (senses_.depth && reading > 0)
        keypoint.depth = static_cast<float>(reading / camera_.depth_factor);
      frame.keypoints.push_back(keypoint);
    }
    return frame;
  }

  Camera camera_;
  Senses senses_;
  DynamicFilter filter_;
  Frame frame_;
};

DynamicsSettings Geometry() {
  DynamicsSettings settings;
  settings.mode = DynamicsMode::kGeometry;
  return settings;
}

const WalkedRoom& Walked() {
  static const WalkedRoom room = WalkRoom({.actors = 2, .frames = 80, .seed = 6});
  return room;
}

// Share of the features on the true people and on the room that remain in use, over all frames.
struct InUse {
  double people = 0, room = 0, all_people = 0, all_room = 0;
  void Add(const Frame& frame, const cv::Mat& truth) {
    cv::Mat wide, narrow;  // ignores features on the outline
    cv::dilate(truth, wide, cv::Mat::ones(5, 5, CV_8U));
    cv::erode(truth, narrow, cv::Mat::ones(5, 5, CV_8U));
    for (size_t k = 0; k < frame.keypoints.size(); ++k) {
      const cv::Point at(static_cast<int>(frame.keypoints[k].raw_x),
                         static_cast<int>(frame.keypoints[k].raw_y));
      const bool used = frame.static_probability[k] >= Frame::kMappable;
      if (narrow.at<uint8_t>(at)) {
        ++all_people;
        people += used;
      } else if (!wide.at<uint8_t>(at)) {
        ++all_room;
        room += used;
      }
    }
  }
};

class FilterOfAWalkedRoom : public testing::Test {
 protected:
  // Plays the room; evaluates from frame `begin` on.
  void Play(Watcher& watcher, const WalkedRoom& room, int begin = 30) {
    for (int i = 0; i < static_cast<int>(room.frames.size()); ++i) {
      watcher.See(i, room.frames[i], room.T_camera_world[i]);
      if (i < begin) continue;
      overlap_ += OverlapOf(watcher.Mask(), room.frames[i].mask);
      cv::Mat wrong;
      cv::bitwise_and(watcher.Mask(), ~room.frames[i].mask, wrong);
      wrong_ = std::max(wrong_, ShareOfMask(wrong));
      in_use_.Add(watcher.frame(), room.frames[i].mask);
      ++looked_;
    }
    overlap_ /= looked_;
  }
  double overlap_ = 0, wrong_ = 0;
  int looked_ = 0;
  InUse in_use_;
};

TEST_F(FilterOfAWalkedRoom, FindsThePeopleByDepthAfterASecond) {
  Watcher watcher(Walked().camera, Geometry());
  Play(watcher, Walked());
  // Cells are 4 pixels wide and people about 40, so the outlines alone cost a fifth.
  EXPECT_GT(overlap_, 0.65);
  EXPECT_LT(wrong_, 0.03);
  EXPECT_LT(in_use_.people, 0.15 * in_use_.all_people);
  EXPECT_GT(in_use_.room, 0.97 * in_use_.all_room);
}

TEST_F(FilterOfAWalkedRoom, FindsThePeopleWithTwoCameras) {
  const WalkedRoom room = WalkRoom({.actors = 2, .frames = 80, .stereo = true, .seed = 6});
  Watcher watcher(room.camera, Geometry(), {.depth = false, .right = true});
  Play(watcher, room);
  EXPECT_GT(overlap_, 0.3);  // block matching widens them
  EXPECT_LT(in_use_.people, 0.4 * in_use_.all_people);
  EXPECT_GT(in_use_.room, 0.85 * in_use_.all_room);  // the part beside people is lost
}

TEST_F(FilterOfAWalkedRoom, LeavesTheRoomAloneWithOneCamera) {
  for (bool pose : {true, false}) {
    in_use_ = {};
    Watcher watcher(Walked().camera, Geometry(), {.depth = false, .right = false, .pose = pose});
    Play(watcher, Walked());
    EXPECT_GT(in_use_.room, 0.95 * in_use_.all_room) << pose;
  }
}

TEST_F(FilterOfAWalkedRoom, MasksNothingInAnEmptyRoom) {
  const WalkedRoom room = WalkRoom({.actors = 0, .frames = 60, .stereo = true, .seed = 3});
  for (const Senses& senses : {Senses{}, Senses{.depth = false, .right = true},
                               Senses{.depth = false}, Senses{.depth = false, .pose = false}}) {
    Watcher watcher(room.camera, Geometry(), senses);
    for (int i = 0; i < 60; ++i) {
      watcher.See(i, room.frames[i], room.T_camera_world[i]);
      ASSERT_LT(ShareOfMask(watcher.Mask()), 0.03) << i;
    }
  }
}

TEST_F(FilterOfAWalkedRoom, ProbabilitiesAreOneForEachFeatureAndProbabilities) {
  Watcher watcher(Walked().camera, Geometry());
  DynamicsSettings settings = Geometry();
  settings.weigh = false;
  Watcher decided(Walked().camera, settings);
  for (int i = 0; i < 40; ++i) {
    watcher.See(i, Walked().frames[i], Walked().T_camera_world[i]);
    decided.See(i, Walked().frames[i], Walked().T_camera_world[i]);
    ASSERT_EQ(watcher.frame().static_probability.size(), watcher.frame().keypoints.size());
    for (float p : watcher.frame().static_probability) {
      ASSERT_GE(p, 0);
      ASSERT_LE(p, 1);
    }
    for (float p : decided.frame().static_probability) ASSERT_TRUE(p == 0 || p == 1);
  }
}

TEST_F(FilterOfAWalkedRoom, TellsTheSameOfTracksWithoutSurfaces) {
  DynamicFilter all(Walked().camera, Geometry(), kNames),
      tracks(Walked().camera, Geometry(), kNames);
  double moved = 0;
  for (int i = 0; i < 40; ++i) {
    const RenderedFrame& seen = Walked().frames[i];
    const PoseGuess guess{Walked().T_camera_world[i], 0.4};
    Frame frame;
    frame.number = i;
    for (DynamicFilter* filter : {&all, &tracks}) {
      filter->Advance({i, seen.time, seen.image, seen.depth, {}}, {});
      filter == &all ? filter->Judge(frame, &guess) : filter->JudgeTracks(&guess);
    }
    ASSERT_EQ(tracks.MovedShare(), all.MovedShare()) << i;
    ASSERT_EQ(tracks.RivalShare(), all.RivalShare()) << i;
    moved = std::max(moved, all.MovedShare());
    for (DynamicFilter* filter : {&all, &tracks}) {
      filter->SeedCorners({});
      filter->Remember(frame, &guess.T_camera_world, {});
    }
  }
  EXPECT_GT(moved, 0.05);
}

TEST_F(FilterOfAWalkedRoom, IsTheSameRunAfterRun) {
  Watcher a(Walked().camera, Geometry()), b(Walked().camera, Geometry());
  for (int i = 0; i < 40; ++i) {
    a.See(i, Walked().frames[i], Walked().T_camera_world[i]);
    b.See(i, Walked().frames[i], Walked().T_camera_world[i]);
    ASSERT_EQ(a.frame().static_probability, b.frame().static_probability);
    ASSERT_EQ(cv::countNonZero(a.Mask() != b.Mask()), 0);
  }
}

TEST_F(FilterOfAWalkedRoom, GoesOnAfterFramesWithoutAPoseAndAfterTheMapWasCorrected) {
  DynamicFilter filter(Walked().camera, Geometry(), {});
  double overlap = 0;
  for (int i = 0; i < 80; ++i) {
    const RenderedFrame& seen = Walked().frames[i];
    filter.Advance({i, seen.time, seen.image, seen.depth, {}}, {});
    Frame frame;
    const bool lost = i >= 20 && i < 25;
    // From frame 10 on the world changes.
    Se3 pose = Walked().T_camera_world[i];
    if (i >= 10) pose = pose * Se3{Eigen::Matrix3d::Identity(), {5, -3, 1}};
    const WorldId world{{}, i >= 10 ? 1u : 0u};
    const PoseGuess guess{pose, 0.4, world};
    filter.Judge(frame, lost ? nullptr : &guess);
    filter.Remember(frame, lost ? nullptr : &pose, world);
    if (i >= 70) overlap += OverlapOf(filter.Mask(), seen.mask) / 10;
  }
  EXPECT_GT(overlap, 0.6);
}

// One room and a stationary camera, in front of which a person is inserted.
class FilterOfAStandingCamera : public testing::Test {
 protected:
  FilterOfAStandingCamera() : room_(WalkRoom({.actors = 0, .frames = 1, .seed = 4})) {
    board_ = MakeTexture(where_.width, where_.height, 12);
  }
  // Slats in front of the lower part of the board, with gaps narrower than a cell.
  void PutUpFence(RenderedFrame& seen) const {
    const cv::Mat slats = MakeTexture(where_.width, 4, 5);
    for (int y = where_.y + 85; y + 6 <= where_.br().y; y += 6) {
      const cv::Rect slat(where_.x, y, where_.width, 4);
      slats.copyTo(seen.image(slat));
      seen.depth(slat) = static_cast<uint16_t>(0.6 * room_.camera.depth_factor);
      seen.mask(slat) = 0;
    }
  }
  RenderedFrame Seen(int number, bool with_board) const {
    RenderedFrame seen = room_.frames[0];
    seen.time = number / 30.0;
    seen.image = seen.image.clone();
    seen.depth = seen.depth.clone();
    seen.mask = cv::Mat::zeros(seen.image.size(), CV_8U);
    if (with_board) {
      board_.copyTo(seen.image(where_));
      seen.depth(where_) = static_cast<uint16_t>(0.9 * room_.camera.depth_factor);
      seen.mask(where_) = 255;
    }
    if (fence_) PutUpFence(seen);
    AddNoise(seen.image, 2, static_cast<uint64_t>(number));
    return seen;
  }
  void See(Watcher& watcher, int frames, bool with_board,
           const std::function<std::optional<FrameDetections>(int)>& answer = nullptr) {
    for (int i = 0; i < frames; ++i, ++number_) {
      watcher.See(number_, Seen(number_, with_board), room_.T_camera_world[0],
                  answer ? answer(number_) : std::nullopt);
    }
  }
  FrameDetections BoardAs(int class_id, int number) const {
    return {number, {{class_id, 0.9f, cv::Rect2f(where_)}}};
  }
  double Overlap(const Watcher& watcher) const {
    return OverlapOf(watcher.Mask(), Seen(0, true).mask);
  }

  WalkedRoom room_;
  cv::Rect where_{120, 60, 70, 110};
  cv::Mat board_;
  bool fence_ = false;
  int number_ = 0;
};

TEST_F(FilterOfAStandingCamera, WhatCameIsLeftOutUntilItHasStayed) {
  Watcher watcher(room_.camera, Geometry());
  See(watcher, 45, false);
  EXPECT_LT(ShareOfMask(watcher.Mask()), 0.01);
  See(watcher, 30, true);
  EXPECT_GT(Overlap(watcher), 0.75);
  See(watcher, 400, true);  // 13 seconds
  EXPECT_LT(Overlap(watcher), 0.1);
  EXPECT_LT(ShareOfMask(watcher.Mask()), 0.02);
}

TEST_F(FilterOfAStandingCamera, WhatGoesAcrossIsLeftOutWithOneCamera) {
  where_.x = 10;
  Watcher watcher(room_.camera, Geometry(), {.depth = false});
  See(watcher, 5, false);
  InUse in_use;
  for (int i = 0; i < 45; ++i) {
    where_.x += 4;  // pixels
    See(watcher, 1, true);
    if (i >= 25) in_use.Add(watcher.frame(), Seen(0, true).mask);
  }
  EXPECT_LT(in_use.people, 0.35 * in_use.all_people);
  EXPECT_GT(in_use.room, 0.85 * in_use.all_room);  // features beside the object get less weight
}

TEST_F(FilterOfAStandingCamera, WhatADetectorKnowsToMoveIsLeftOutThoughItRests) {
  DynamicsSettings settings = Geometry();
  settings.mode = DynamicsMode::kFull;
  Watcher watcher(room_.camera, settings);
  const auto person = [&](int number) -> std::optional<FrameDetections> {
    if (number % 6 != 0) return std::nullopt;
    return BoardAs(0, number);
  };
  See(watcher, 1, true, person);
  EXPECT_GT(Overlap(watcher), 0.7);  // from the first frame on
  See(watcher, 300, true, person);
  EXPECT_GT(Overlap(watcher), 0.7);
  ASSERT_EQ(watcher.filter().objects().size(), 1u);
  // It disappears, and after some time it is no longer expected.
  See(watcher, 60, false);
  EXPECT_TRUE(watcher.filter().objects().empty());
  EXPECT_LT(ShareOfMask(watcher.Mask()), 0.03);
}

TEST_F(FilterOfAStandingCamera, WhatIsSeenThroughAFenceIsJudgedAsWhatIsBesideIt) {
  DynamicsSettings settings = Geometry();
  settings.mode = DynamicsMode::kFull;
  Watcher watcher(room_.camera, settings);
  fence_ = true;
  See(watcher, 40, false);
  InUse in_use;
  for (int i = 0; i < 20; ++i) {
    See(watcher, 1, true, [&](int number) { return BoardAs(0, number); });
    for (size_t k = 0; k < watcher.frame().keypoints.size(); ++k) {
      const Keypoint& keypoint = watcher.frame().keypoints[k];
      if (keypoint.raw_y < static_cast<float>(where_.y) + 87 || keypoint.depth < 0.85f ||
          keypoint.depth > 0.95f)
        continue;
      ++in_use.all_people;
      in_use.people += watcher.frame().static_probability[k] >= Frame::kMappable;
    }
  }
  ASSERT_GT(in_use.all_people, 20);
  EXPECT_LT(in_use.people, 0.3 * in_use.all_people);
}

TEST_F(FilterOfAStandingCamera, WhatIsOnlyCarriedAlongIsUsedWhileItRests) {
  DynamicsSettings settings = Geometry();
  settings.mode = DynamicsMode::kFull;
  Watcher watcher(room_.camera, settings);
  See(watcher, 60, true, [&](int number) { return BoardAs(1, number); });
  EXPECT_EQ(watcher.filter().objects().size(), 1u);
  EXPECT_LT(ShareOfMask(watcher.Mask()), 0.01);
}

TEST_F(FilterOfAStandingCamera, WithoutForegroundTheBoxIsLeftOut) {
  DynamicsSettings settings = Geometry();
  settings.mode = DynamicsMode::kFull;
  const cv::Rect2f wide(90, 40, 130, 150);
  const auto answer = [&](int number) { return FrameDetections{number, {{0, 0.9f, wide}}}; };
  Watcher cut(room_.camera, settings);
  See(cut, 1, true, answer);
  settings.foreground = false;
  Watcher boxes(room_.camera, settings);
  See(boxes, 1, true, answer);
  EXPECT_GT(ShareOfMask(boxes.Mask()), 1.5 * ShareOfMask(cut.Mask()));
  EXPECT_GT(Overlap(cut), 0.7);
}

TEST_F(FilterOfAStandingCamera, ADetectionOfTheWholePictureIsOfNoHarm) {
  DynamicsSettings settings = Geometry();
  settings.mode = DynamicsMode::kFull;
  for (const Senses& senses : {Senses{}, Senses{.depth = false}}) {
    Watcher watcher(room_.camera, settings, senses);
    See(watcher, 10, true, [&](int number) {
      return FrameDetections{number, {{0, 0.9f, cv::Rect2f(0, 0, 320, 240)}}};
    });
    EXPECT_GT(ShareOfMask(watcher.Mask()), 0.05);
    See(watcher, 60, true);
    EXPECT_LT(ShareOfMask(watcher.Mask()), 0.1);
  }
}

}  // namespace
}  // namespace alidade::dynamic_filter_test
