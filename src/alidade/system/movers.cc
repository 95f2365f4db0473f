#include "alidade/system/movers.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "alidade/features/subset.h"

namespace alidade {

// A keyframe keeps only keypoints that may enter the map. Their matches suffice if they are all
// matches, or at least kLeast and kShare of all.
bool HoldsWithoutMovers(const PlacedFrame& placed) {
  constexpr int kLeast = 20;
  constexpr double kShare = 0.25;
  int tied = 0, all = 0;
  for (size_t k = 0; k < placed.matches.size(); ++k) {
    if (!placed.matches[k].valid()) continue;
    ++all;
    tied += placed.frame->Static(static_cast<int>(k)) >= Frame::kMappable;
  }
  return tied == all || (tied >= kLeast && tied >= kShare * all);
}

WorldId WorldOf(KeyFrameId reference, const MapSnapshot& map) {
  return {map.MapOf(reference), map.corrections()};
}

// The smallest depth in the scene is taken as kNearer times the 5 % quantile of the depths of the
// matched landmarks.
PoseGuess GuessOf(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map) {
  constexpr double kNearer = 0.4;
  PoseGuess guess;
  guess.T_camera_world = placed.T_camera_world;
  guess.world = WorldOf(reference, map);
  std::vector<double> depths;
  for (LandmarkId id : placed.matches) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (landmark) depths.push_back((placed.T_camera_world * landmark->p_world).z());
  }
  if (depths.empty()) return guess;
  const auto low = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 20);
  std::nth_element(depths.begin(), low, depths.end());
  guess.nearest = kNearer * std::max(*low, 1e-6);
  return guess;
}

std::vector<int> MappableKeypoints(const Frame& frame) {
  std::vector<int> kept;
  for (int k = 0; k < static_cast<int>(frame.keypoints.size()); ++k) {
    if (frame.Static(k) >= Frame::kMappable) kept.push_back(k);
  }
  return kept;
}

// The map gets no keypoints on objects that may move.
void LeaveOutMovers(PlacedFrame& placed, const Camera& camera) {
  const std::vector<int> kept = MappableKeypoints(*placed.frame);
  if (kept.size() == placed.frame->keypoints.size()) return;
  std::vector<LandmarkId> matches;
  if (!placed.matches.empty()) {
    for (int k : kept) matches.push_back(placed.matches[k]);
  }
  auto frame = std::make_shared<Frame>(KeypointSubset(*placed.frame, kept, camera));
  frame->picture = nullptr;  // the map holds no images
  placed.frame = std::move(frame);
  placed.matches = std::move(matches);
  placed.passing.clear();
  placed.inliers =
      static_cast<int>(std::count_if(placed.matches.begin(), placed.matches.end(),
                                     [](LandmarkId landmark) { return landmark.valid(); }));
}

}  // namespace alidade
