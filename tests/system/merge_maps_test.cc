// Maps of several recordings: merged if they show the same place, in any order, and kept apart
// otherwise.
#include "alidade/system/merge_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

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
Visit Play(const std::string& scene, int first, int last, Sensor sensor = Sensor::kRgbd) {
  RenderedFrames& recording = Scene(scene);
  SlamSettings settings;
  settings.sensor = sensor;
  Slam slam(recording.camera(), settings);
  Visit visit;
  for (int i = first; i <= last; i += 3) {
    const RenderedFrame& frame = recording.Frame(i);
    slam.Track({0.1 * static_cast<double>(visit.numbers.size()), frame.image, {}, frame.depth});
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

}  // namespace
}  // namespace alidade::merge_maps_test
