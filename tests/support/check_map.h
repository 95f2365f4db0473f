// Invariants of every published map.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

inline void ExpectConsistent(const MapSnapshot& map) {
  int observations = 0, shown = 0;
  for (LandmarkId id : map.Landmarks()) {
    const Landmark& landmark = *map.Find(id);
    EXPECT_EQ(landmark.id, id);
    EXPECT_FALSE(landmark.observations.empty());
    bool reference_sees_it = false;
    for (size_t i = 0; i < landmark.observations.size(); ++i) {
      const Observation& seen = landmark.observations[i];
      if (i > 0) {
        EXPECT_LT(landmark.observations[i - 1].keyframe, seen.keyframe);
      }
      const KeyFrame* keyframe = map.Find(seen.keyframe);
      ASSERT_NE(keyframe, nullptr);
      EXPECT_EQ(keyframe->landmarks.at(seen.keypoint), id);
      EXPECT_EQ(keyframe->map, map.Find(landmark.observations[0].keyframe)->map);
      reference_sees_it = reference_sees_it || seen.keyframe == landmark.reference;
      ++observations;
    }
    EXPECT_TRUE(reference_sees_it);
  }
  std::vector<MapId> with_root;
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    EXPECT_EQ(keyframe.id, id);
    ASSERT_EQ(keyframe.landmarks.size(), keyframe.frame->keypoints.size());
    for (LandmarkId landmark : keyframe.landmarks) shown += landmark.valid();
    if (keyframe.parent.valid()) {
      EXPECT_LT(keyframe.parent, id);
      ASSERT_NE(map.Find(keyframe.parent), nullptr);
      EXPECT_EQ(map.Find(keyframe.parent)->map, keyframe.map);
    } else {
      with_root.push_back(keyframe.map);
    }
    EXPECT_TRUE(std::is_sorted(keyframe.loops.begin(), keyframe.loops.end()));
    for (KeyFrameId loop : keyframe.loops) {
      const KeyFrame* other = map.Find(loop);
      ASSERT_NE(other, nullptr);
      EXPECT_TRUE(std::binary_search(other->loops.begin(), other->loops.end(), id));
      EXPECT_EQ(other->map, keyframe.map);
    }
    for (const Neighbour& neighbour : keyframe.covisible) {
      const KeyFrame* other = map.Find(neighbour.id);
      ASSERT_NE(other, nullptr);
      EXPECT_EQ(other->map, keyframe.map);
      bool returned = false;
      for (const Neighbour& back : other->covisible)
        returned = returned || (back.id == id && back.shared == neighbour.shared);
      EXPECT_TRUE(returned);
    }
  }
  std::sort(with_root.begin(), with_root.end());
  EXPECT_EQ(with_root, map.Maps());  // each map is one connected tree
  EXPECT_EQ(observations, shown);    // observations are consistent on both sides
  EXPECT_EQ(map.keyframe_count(), static_cast<int>(map.KeyFrames().size()));
  EXPECT_EQ(map.landmark_count(), static_cast<int>(map.Landmarks().size()));
}

}  // namespace alidade
