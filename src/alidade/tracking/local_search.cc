#include "alidade/tracking/local_search.h"

#include <algorithm>

#include "alidade/base/id_map.h"
#include "alidade/base/parallel.h"
#include "alidade/base/part_times.h"
#include "alidade/features/guided_search.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

constexpr int kChunk = 256;        // landmarks per task
constexpr double kHeadOn = 0.998;  // cosine to the mean viewing direction
// Relative to the radius at oblique views: 2.5 to 4 (Mur-Artal et al. 2015).
constexpr float kHeadOnRadius = 0.625;

struct Candidate {
  const Landmark* landmark;
  Sighting sighting;
  ExpectedLandmark expected;
  bool visible = false;
};

void LookFor(Candidate& candidate, const PlacedFrame& placed, const Camera& camera, float radius) {
  const auto view = ViewLandmark(*candidate.landmark, camera, placed.T_camera_world);
  if (!view) return;
  candidate.visible = true;
  candidate.expected = {candidate.landmark->id, static_cast<float>(view->pixel.x()),
                        static_cast<float>(view->pixel.y()), view->level};
  Sought sought;
  sought.descriptor = &candidate.landmark->descriptor;
  sought.x = static_cast<float>(view->pixel.x());
  sought.y = static_cast<float>(view->pixel.y());
  sought.right_x = static_cast<float>(view->right_x);
  sought.radius = radius * (view->cosine > kHeadOn ? kHeadOnRadius : 1.0f) *
                  static_cast<float>(ScaleOfLevel(view->level));
  sought.min_level = view->level - 1;
  sought.max_level = view->level;
  candidate.sighting = FindNear(*placed.frame, sought, [&](int k) {
    return !placed.matches[k].valid() && placed.frame->IsUsable(k);
  });
}

}  // namespace

LocalMatches MatchLocalMap(const PlacedFrame& placed, const LocalMap& local, const Camera& camera,
                           const TrackerSettings& settings) {
  const PartTimer timer(FramePart::kLocalSearch);
  LocalMatches found{placed.matches, {}};
  IdSet<LandmarkId> known;
  for (LandmarkId id : placed.matches) {
    if (id.valid()) known.Enter(id);
  }
  std::vector<Candidate> candidates;
  candidates.reserve(local.landmarks.size());
  for (const Landmark* landmark : local.landmarks) {
    if (!known.Contains(landmark->id)) candidates.push_back({landmark, {}, {}, false});
  }
  // Search in parallel; conflicts are resolved afterwards, in order.
  const float radius =
      camera.StereoBaseline() > 0 ? settings.local_radius_depth : settings.local_radius;
  const int count = static_cast<int>(candidates.size());
  ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
    const int end = std::min(count, (chunk + 1) * kChunk);
    for (int i = chunk * kChunk; i < end; ++i) LookFor(candidates[i], placed, camera, radius);
  });

  std::vector<int> holder(found.matches.size(), -1);  // index of the candidate, by keypoint
  for (int i = 0; i < count; ++i) {
    if (candidates[i].visible) found.visible.push_back(candidates[i].expected);
    const Sighting& s = candidates[i].sighting;
    if (s.keypoint < 0 || s.distance > settings.max_distance) continue;
    const bool rival = s.level == s.second_level;
    if (rival && s.distance > settings.local_ratio * s.second_distance) continue;
    int& held = holder[s.keypoint];
    if (held < 0 || s.distance < candidates[held].sighting.distance) held = i;
  }
  for (size_t k = 0; k < holder.size(); ++k) {
    if (holder[k] >= 0) found.matches[k] = candidates[holder[k]].landmark->id;
  }
  return found;
}

}  // namespace alidade
