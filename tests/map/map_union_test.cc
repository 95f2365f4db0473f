// Union of several maps: only ids change.
#include "alidade/map/map_union.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "problems/drifted_map.h"
#include "support/check_map.h"

namespace alidade::map_union_test {
namespace {

MapSnapshot MapOfCameras(int cameras) {
  MapStore store;
  FillDriftedMap(MakeSyntheticWorld({.points = 100, .cameras = cameras}), {}, store);
  return store.Snapshot();
}

TEST(Unite, KeepsEveryMapApartAndConsistent) {
  const std::vector<MapSnapshot> maps = {MapOfCameras(5), MapOfCameras(3), MapOfCameras(4)};
  const MapUnion all = Unite(maps);
  ExpectConsistent(all.map);
  EXPECT_EQ(all.map.Maps().size(), 3u);
  EXPECT_EQ(all.map.keyframe_count(), 12);
  ASSERT_EQ(all.parts.size(), 3u);
  for (size_t i = 0; i < maps.size(); ++i) {
    const UnitedPart& part = all.parts[i];
    for (KeyFrameId id : maps[i].KeyFrames()) {
      const KeyFrameId there{id.value + part.first_keyframe};
      EXPECT_EQ(all.PartOf(there), i);
      const KeyFrame &a = *maps[i].Find(id), *b = all.map.Find(there);
      ASSERT_NE(b, nullptr);
      EXPECT_EQ(a.T_camera_world.t, b->T_camera_world.t);
      EXPECT_EQ(a.covisible.size(), b->covisible.size());
      EXPECT_EQ(b->map.value, a.map.value + part.first_map);
      EXPECT_EQ(b->frame->number, a.frame->number + part.first_frame);
      for (size_t k = 0; k < a.landmarks.size(); ++k) {
        EXPECT_EQ(a.landmarks[k].valid(), b->landmarks[k].valid());
        if (!a.landmarks[k].valid()) continue;
        const Landmark* landmark =
            all.map.Find(LandmarkId{a.landmarks[k].value + part.first_landmark});
        ASSERT_NE(landmark, nullptr);
        EXPECT_EQ(landmark->id, b->landmarks[k]);
        EXPECT_EQ(landmark->p_world, maps[i].Find(a.landmarks[k])->p_world);
      }
    }
  }
}

TEST(Unite, FrameNumbersGoOnFromMapToMap) {
  const std::vector<MapSnapshot> maps = {MapOfCameras(4), MapOfCameras(4)};
  const MapUnion all = Unite(maps);
  int last_of_first = 0;
  for (KeyFrameId id : maps[0].KeyFrames())
    last_of_first = std::max(last_of_first, maps[0].Find(id)->frame->number);
  EXPECT_EQ(all.parts[1].first_frame, last_of_first + 1);
}

TEST(Unite, OfNothingIsEmpty) {
  const MapUnion none = Unite({});
  EXPECT_EQ(none.map.keyframe_count(), 0);
  const std::vector<MapSnapshot> with_empty = {MapSnapshot(), MapOfCameras(3)};
  const MapUnion one = Unite(with_empty);
  EXPECT_EQ(one.map.keyframe_count(), 3);
  EXPECT_EQ(one.PartOf(one.map.KeyFrames().front()), 1u);
}

}  // namespace
}  // namespace alidade::map_union_test
