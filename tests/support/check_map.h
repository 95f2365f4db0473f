// What must hold in every published map, whatever was done to it.
#pragma once

#include <gtest/gtest.h>

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
      reference_sees_it = reference_sees_it || seen.keyframe == landmark.reference;
      ++observations;
    }
    EXPECT_TRUE(reference_sees_it);
  }
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    EXPECT_EQ(keyframe.id, id);
    ASSERT_EQ(keyframe.landmarks.size(), keyframe.frame->keypoints.size());
    for (LandmarkId landmark : keyframe.landmarks) shown += landmark.valid();
    if (keyframe.parent.valid()) {
      EXPECT_LT(keyframe.parent, id);
      EXPECT_NE(map.Find(keyframe.parent), nullptr);
    }
    for (const Neighbour& neighbour : keyframe.covisible) {
      const KeyFrame* other = map.Find(neighbour.id);
      ASSERT_NE(other, nullptr);
      bool returned = false;
      for (const Neighbour& back : other->covisible)
        returned = returned || (back.id == id && back.shared == neighbour.shared);
      EXPECT_TRUE(returned);
    }
  }
  EXPECT_EQ(observations, shown);  // each is known on both sides
  EXPECT_EQ(map.keyframe_count(), static_cast<int>(map.KeyFrames().size()));
  EXPECT_EQ(map.landmark_count(), static_cast<int>(map.Landmarks().size()));
}

}  // namespace alidade
