#include "alidade/map/fusion.h"

#include <algorithm>

#include "alidade/features/guided_search.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

// True if the keypoint is at the landmark's predicted position: chi² test (95 %) of the pixel, and
// of the disparity if there is one.
bool Fits(const LandmarkView& view, const Keypoint& keypoint, const MeasurementNoise& noise,
          bool has_depth) {
  const Measurement m = Measure(keypoint, noise);
  const double error = (view.pixel - keypoint.pixel()).squaredNorm() * m.inv_sigma2;
  if (!has_depth || !keypoint.has_depth()) return error < 5.991;
  const double right = (view.pixel.x() - view.right_x) - (keypoint.x - keypoint.right_x);
  return error + right * right * m.inv_sigma2_right < 7.815;
}

}  // namespace

std::vector<FusedSighting> FindLandmarks(const MapSnapshot& map,
                                         std::span<const LandmarkId> landmarks,
                                         const KeyFrame& keyframe, const Se3& T_camera_world,
                                         const Camera& camera, const LandmarkSearch& search,
                                         int* visible) {
  const bool has_depth = camera.bf() > 0;
  std::vector<FusedSighting> found;
  int in_view = 0;
  for (LandmarkId id : landmarks) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const bool seen = std::any_of(landmark->observations.begin(), landmark->observations.end(),
                                  [&](const Observation& o) { return o.keyframe == keyframe.id; });
    if (seen) continue;
    const auto view = ViewLandmark(*landmark, camera, T_camera_world);
    if (!view) continue;
    ++in_view;
    Sought sought;
    sought.descriptor = &landmark->descriptor;
    sought.x = static_cast<float>(view->pixel.x());
    sought.y = static_cast<float>(view->pixel.y());
    sought.radius = static_cast<float>(search.radius * ScaleOfLevel(view->level));
    sought.min_level = view->level - 1;
    sought.max_level = view->level;
    const Sighting sighting = FindNear(*keyframe.frame, sought, [&](int i) {
      return !search.gate || Fits(*view, keyframe.frame->keypoints[i], *search.gate, has_depth);
    });
    if (sighting.keypoint < 0 || sighting.distance > search.max_distance) continue;
    found.push_back({id, keyframe.id, sighting.keypoint});
  }
  if (visible) *visible = in_view;
  return found;
}

std::vector<LandmarkId> CommitFusion(MapCommit& commit,
                                     const std::vector<FusedSighting>& sightings) {
  std::vector<LandmarkId> touched;
  for (const FusedSighting& s : sightings) {
    const Landmark* landmark = commit.Find(s.landmark);
    const KeyFrame* keyframe = commit.Find(s.keyframe);
    if (!landmark || !keyframe) continue;
    const LandmarkId holder = keyframe->landmarks[s.keypoint];
    if (!holder.valid()) {
      if (commit.AddObservation(s.landmark, s.keyframe, s.keypoint)) touched.push_back(s.landmark);
      continue;
    }
    if (holder == s.landmark || !commit.Find(holder)) continue;
    const bool keep_holder =
        commit.Find(holder)->observations.size() > landmark->observations.size();
    const LandmarkId kept = keep_holder ? holder : s.landmark,
                     gone = keep_holder ? s.landmark : holder;
    commit.Replace(gone, kept);
    touched.push_back(kept);
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

}  // namespace alidade
