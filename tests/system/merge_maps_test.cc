// Maps of several recordings: merged if they show the same place, in any order, and kept apart
// otherwise.
#include "alidade/system/merge_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "alidade/geometry/alignment.h"
#include "alidade/slam.h"
#include "support/check_map.h"
#include "support/expect_error.h"
#include "support/rendered_frames.h"

namespace alidade::merge_maps_test {
namespace {

struct Visit {
  MapToMerge map;
  Se3 T_truth_world;         // true pose of its first frame
  std::vector<int> numbers;  // frame of the scene's path for each frame of the visit
};

RenderedFrames& Scene(const std::string& name) {
  SynthSettings settings;
  settings.scene = name;
  settings.width = 320;
  settings.height = 240;
  return FramesOf(settings);
}

// Frames `first`, `first` + 3, … of a scene's path.
Visit Play(const std::string& scene, int first, int last, Sensor sensor = Sensor::kRgbd,
           const std::optional<Camera>& calibration = {}) {
  RenderedFrames& recording = Scene(scene);
  SlamSettings settings;
  settings.sensor = sensor;
  Slam slam(calibration.value_or(recording.camera()), settings);
  Visit visit;
  for (int i = first; i <= last; i += 3) {
    const RenderedFrame& frame = recording.Frame(i);
    const cv::Mat depth = sensor == Sensor::kRgbd ? frame.depth : cv::Mat();
    slam.Track({0.1 * static_cast<double>(visit.numbers.size()), frame.image, {}, depth});
    visit.numbers.push_back(i);
  }
  slam.Finish();
  visit.map = {scene + std::to_string(first), DecodeMap(slam.SaveMap())};
  visit.T_truth_world = recording.Pose(first);
  return visit;
}

// Largest position error of a part's keyframes, meters, if the world frame is that of `first`.
double WorstOf(const MergedMaps& merged, const UnitedPart& part, const Visit& visit,
               const Visit& first, const std::string& scene) {
  double worst = 0;
  for (KeyFrameId id : merged.saved.map.KeyFrames()) {
    if (id.value < part.first_keyframe || id.value >= part.end_keyframe) continue;
    const KeyFrame& keyframe = *merged.saved.map.Find(id);
    const int number =
        visit.numbers[static_cast<size_t>(keyframe.frame->number - part.first_frame)];
    const Se3 truth = first.T_truth_world.Inverse() * Scene(scene).Pose(number);
    worst = std::max(worst, (keyframe.Centre() - truth.t).norm());
  }
  return worst;
}

class MergeMapsOfARoom : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    early_ = new Visit(Play("room", 0, 120));
    late_ = new Visit(Play("room", 90, 180));
    desk_ = new Visit(Play("desk", 0, 60));
  }
  static Visit *early_, *late_, *desk_;
};
Visit* MergeMapsOfARoom::early_ = nullptr;
Visit* MergeMapsOfARoom::late_ = nullptr;
Visit* MergeMapsOfARoom::desk_ = nullptr;

TEST_F(MergeMapsOfARoom, TwoVisitsBecomeOneMapAsTrueAsEach) {
  const MergedMaps merged = MergeMaps({early_->map, late_->map});
  ExpectConsistent(merged.saved.map);
  ASSERT_EQ(merged.saved.map.Maps().size(), 1u);
  EXPECT_EQ(merged.joins.size(), 1u);
  const bool early_first = merged.parts[0].first_keyframe == 0;
  const Visit& first = early_first ? *early_ : *late_;
  EXPECT_LT(WorstOf(merged, merged.parts[0], *early_, first, "room"), 0.03);
  EXPECT_LT(WorstOf(merged, merged.parts[1], *late_, first, "room"), 0.03);
  // Landmarks that both visits observe.
  int shared = 0;
  for (LandmarkId id : merged.saved.map.Landmarks()) {
    const auto& seen = merged.saved.map.Find(id)->observations;
    const uint32_t border = merged.parts[early_first ? 1 : 0].first_keyframe;
    shared += seen.front().keyframe.value < border && seen.back().keyframe.value >= border;
  }
  EXPECT_GT(shared, 100);
}

TEST_F(MergeMapsOfARoom, TheOrderDoesNotMatter) {
  const MergedMaps ab = MergeMaps({early_->map, late_->map, desk_->map});
  const MergedMaps ba = MergeMaps({desk_->map, late_->map, early_->map});
  EXPECT_EQ(EncodeMap(ab.saved), EncodeMap(ba.saved));
  EXPECT_EQ(ab.parts[0].first_keyframe, ba.parts[2].first_keyframe);
  EXPECT_EQ(ab.parts[2].first_keyframe, ba.parts[0].first_keyframe);
}

TEST_F(MergeMapsOfARoom, AnotherPlaceStaysApartAndAsItWas) {
  const MergedMaps merged = MergeMaps({early_->map, desk_->map});
  ExpectConsistent(merged.saved.map);
  EXPECT_EQ(merged.saved.map.Maps().size(), 2u);
  EXPECT_TRUE(merged.joins.empty());
  const MapSnapshot& before = desk_->map.saved.map;
  for (KeyFrameId id : before.KeyFrames()) {
    const KeyFrame* now =
        merged.saved.map.Find(KeyFrameId{id.value + merged.parts[1].first_keyframe});
    ASSERT_NE(now, nullptr);
    EXPECT_EQ(now->T_camera_world.t, before.Find(id)->T_camera_world.t);
  }
}

TEST_F(MergeMapsOfARoom, AMergedMapIsGoneOnWith) {
  const MergedMaps merged = MergeMaps({early_->map, late_->map});
  const SavedMap again = DecodeMap(EncodeMap(merged.saved));
  SlamSettings settings;
  settings.sensor = Sensor::kRgbd;
  Slam slam(Scene("room").camera(), settings);
  slam.Load(again);
  int tracked = 0;
  for (int i = 0; i < 5; ++i) {  // where only the late visit was
    const RenderedFrame& frame = Scene("room").Frame(160 + i);
    tracked += slam.Track({0.1 * i, frame.image, {}, frame.depth}).state == TrackState::kTracking;
  }
  EXPECT_GE(tracked, 4);
}

TEST_F(MergeMapsOfARoom, WhatCannotBeTogetherIsSaid) {
  const auto complaint = [](ErrorKind kind, const std::vector<MapToMerge>& maps) {
    return MessageOf(kind, [&] { MergeMaps(maps); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(complaint(ErrorKind::kUsage, {early_->map}), HasSubstr("at least two maps"));
  EXPECT_THAT(complaint(ErrorKind::kInput, {early_->map, early_->map}), HasSubstr("the same map"));
  MapToMerge other = late_->map;
  other.name = "other";
  other.saved.sensor = "mono";
  EXPECT_THAT(complaint(ErrorKind::kInput, {early_->map, other}), HasSubstr("mono camera"));
  other.saved.sensor = "rgbd";
  other.saved.camera.fx *= 1.1;
  EXPECT_THAT(complaint(ErrorKind::kInput, {early_->map, other}), HasSubstr("another camera"));
}

// Mean distance of a part's keyframes to the truth, meters, after the best similarity.
double MeanOffTruth(const MergedMaps& merged, const UnitedPart& part, const Visit& visit) {
  std::vector<Eigen::Vector3d> truth, found;
  for (KeyFrameId id : merged.saved.map.KeyFrames()) {
    if (id.value < part.first_keyframe || id.value >= part.end_keyframe) continue;
    const KeyFrame& keyframe = *merged.saved.map.Find(id);
    const int number =
        visit.numbers[static_cast<size_t>(keyframe.frame->number - part.first_frame)];
    truth.push_back(Scene("room").Pose(number).t);
    found.push_back(keyframe.Centre());
  }
  const Sim3 T = AlignPoints(truth, found, true);
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i) sum += (T * found[i] - truth[i]).norm();
  return sum / static_cast<double>(truth.size());
}

// One camera, calibrated twice: by the truth, and 0.8 % off with a little distortion.
TEST(MergeMapsOfOneCamera, AnotherCalibrationIsReplaced) {
  Camera good = Scene("room").camera();
  good.depth_factor = 0;
  good.focal_sigma = 0.003;
  Camera off = good;
  off.fx *= 1.008;
  off.fy *= 1.008;
  off.distortion = {0.01, 0, 0, 0, 0};
  const Visit early = Play("room", 0, 210, Sensor::kMono, good);
  const Visit late = Play("room", 90, 240, Sensor::kMono, off);
  ASSERT_GT(early.map.saved.map.keyframe_count(), late.map.saved.map.keyframe_count());
  EXPECT_DOUBLE_EQ(late.map.saved.camera.focal_sigma, 0.003);

  ASSERT_GT(late.map.saved.map.keyframe_count(), 4);

  const MergedMaps merged = MergeMaps({early.map, late.map});
  ExpectConsistent(merged.saved.map);
  EXPECT_DOUBLE_EQ(merged.saved.camera.fx, good.fx);
  EXPECT_EQ(merged.camera_shifts[0], 0);
  EXPECT_NEAR(merged.camera_shifts[1], CameraShift(good, off), 1e-9);
  EXPECT_EQ(merged.saved.map.Maps().size(), 1u);
  EXPECT_LT(MeanOffTruth(merged, merged.parts[0], early), 0.03);
  EXPECT_LT(MeanOffTruth(merged, merged.parts[1], late), 0.03);
  // The good camera has no distortion: its keypoints are where they are in the image.
  for (KeyFrameId id : merged.saved.map.KeyFrames()) {
    const Frame& frame = *merged.saved.map.Find(id)->frame;
    ASSERT_NEAR(frame.keypoints.front().x, frame.keypoints.front().raw_x, 1e-3);
    ASSERT_NEAR(frame.keypoints.back().y, frame.keypoints.back().raw_y, 1e-3);
  }

  MapToMerge sure = late.map;  // says that it is exact
  MapToMerge other = early.map;
  sure.saved.camera.focal_sigma = other.saved.camera.focal_sigma = 0;
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          MergeMaps({other, sure});
                        }),
              testing::HasSubstr("another camera"));
}

}  // namespace
}  // namespace alidade::merge_maps_test
