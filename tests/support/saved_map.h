// A map with all kinds of content: culled keyframes and landmarks, forwarded ids, depth and
// clutter, two maps, loops, scales, and a vocabulary.
#pragma once

#include <string>
#include <vector>

#include "alidade/map/map_file.h"
#include "problems/synthetic_map.h"
#include "support/check_map.h"

namespace alidade {

struct SavedMapSettings {
  int points = 200;
  int cameras = 9;
  int clutter = 20;
  bool second_map = true;
  bool loops = true;  // also scales other than 1
  bool places = true;
};

inline SavedMap MakeSavedMap(const SavedMapSettings& settings = {}) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = settings.points,
                                                   .cameras = settings.cameras,
                                                   .noise_px = 1,
                                                   .flipped_bits = 10,
                                                   .clutter = settings.clutter,
                                                   .depth = true});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.pose_sigma = 0.01, .point_sigma = 0.02}, store);
  if (settings.second_map) FillMap(world, {.point_sigma = 0.01, .keyframes = 4}, store);
  SavedMap saved;
  saved.map = store.Commit([&](MapCommit& commit) {
    std::vector<LandmarkId> ids;
    for (uint32_t i = 0; i < commit.next_landmark(); ++i) ids.push_back({i});
    const size_t some = made.landmarks.size() / 10;
    commit.Remove(ids[7]);
    commit.Replace(ids[some], ids[some + 1]);
    commit.Replace(ids[some + 1], ids[some + 2]);  // a chain
    commit.Replace(ids[some + 5], ids[some + 6]);
    commit.Remove(ids[some + 6]);  // a dangling forward
    if (settings.loops) {
      commit.AddLoop(made.keyframes.front(), made.keyframes.back());
      for (size_t i = 2; i < made.keyframes.size(); ++i) {
        commit.Edit(made.keyframes[i])->scale = 1 + 0.01 * static_cast<double>(i);
      }
    }
    const size_t middle = made.keyframes.size() / 3;
    commit.Remove(made.keyframes[middle + 1]);
    commit.Remove(made.keyframes[middle]);  // the parent of the one before
    for (LandmarkId id : ids) commit.RefreshLandmark(id);
  });
  ExpectConsistent(saved.map);
  saved.camera = world.camera;
  saved.camera.distortion = {0.1, -0.05, 0.001, 0.002, 0.01};
  saved.sensor = "rgbd";
  saved.settings = {{"seed", "1"}, {"tracker.extractor.features", "1000"}};
  if (settings.places) {
    std::vector<Descriptor> sample;
    for (KeyFrameId id : saved.map.KeyFrames()) {
      const auto& descriptors = saved.map.Find(id)->frame->descriptors;
      sample.insert(sample.end(), descriptors.begin(), descriptors.end());
    }
    saved.places.nodes = Vocabulary::Grow(sample, {.branching = 4, .levels = 3}, 1).nodes();
    saved.places.grown_at = static_cast<uint32_t>(saved.map.keyframe_count());
  }
  return saved;
}

}  // namespace alidade
