// Everything a program does with a map it has read.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/map/map_file.h"

namespace alidade {

// Returns what went wrong; "" if nothing.
inline std::string UseMap(const SavedMap& saved) {
  const std::string bytes = EncodeMap(saved);
  if (EncodeMap(DecodeMap(bytes)) != bytes) return "what was read cannot be kept";
  for (uint32_t i = 0; i < saved.map.next_keyframe() && i < 1000; ++i) {
    if (!saved.map.PoseOf({i}).t.allFinite()) return "a pose is not finite";
    if (!std::isfinite(saved.map.ScaleOf({i}))) return "a scale is not finite";
  }
  PlaceIndex places;
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Frame>>> frames;
  for (KeyFrameId id : saved.map.KeyFrames()) frames.push_back({id, saved.map.Find(id)->frame});
  places.Restore(saved.places, frames);
  if (!frames.empty()) places.Query(*frames.back().second, {}, 3);
  MapStore store;
  store.Restore(saved.map);
  store.Commit([&](MapCommit& commit) {
    for (LandmarkId id : saved.map.Landmarks()) commit.RefreshLandmark(id);
    for (size_t i = 0; i < frames.size(); ++i) {
      commit.RefreshCovisibility(frames[i].first);
      if (i % 3 == 2) commit.Remove(frames[i].first);
    }
  });
  CheckSameCamera(saved.camera, saved.camera);
  return "";
}

}  // namespace alidade
