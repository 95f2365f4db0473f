#include "alidade/mapping/fuse.h"

#include <algorithm>

#include "alidade/base/parallel.h"
#include "alidade/features/guided_search.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

void FindIn(const MapSnapshot& map, const std::vector<LandmarkId>& landmarks,
            const KeyFrame& keyframe, const Camera& camera, const MapperSettings& settings,
            std::vector<FusedSighting>& found) {
  const double bf = camera.bf();
  for (LandmarkId id : landmarks) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const bool seen = std::any_of(landmark->observations.begin(), landmark->observations.end(),
                                  [&](const Observation& o) { return o.keyframe == keyframe.id; });
    if (seen) continue;
    const auto view = ViewLandmark(*landmark, camera, keyframe.T_camera_world);
    if (!view) continue;
    Sought sought;
    sought.descriptor = &landmark->descriptor;
    sought.x = static_cast<float>(view->pixel.x());
    sought.y = static_cast<float>(view->pixel.y());
    sought.radius = static_cast<float>(settings.fuse_radius * ScaleOfLevel(view->level));
    sought.min_level = view->level - 1;
    sought.max_level = view->level;
    const Sighting sighting = FindNear(*keyframe.frame, sought, [&](int i) {
      const Keypoint& keypoint = keyframe.frame->keypoints[i];
      const Measurement m = Measure(keypoint, settings.noise);
      const double error = (view->pixel - keypoint.pixel()).squaredNorm() * m.inv_sigma2;
      if (!(bf > 0 && keypoint.has_depth())) return error < 5.991;
      const double right = (view->pixel.x() - view->right_x) - (keypoint.x - keypoint.right_x);
      return error + right * right * m.inv_sigma2_right < 7.815;
    });
    if (sighting.keypoint < 0 || sighting.distance > settings.fuse_distance) continue;
    found.push_back({id, keyframe.id, sighting.keypoint});
  }
}

}  // namespace

std::vector<FusedSighting> FindDuplicates(const MapSnapshot& map, KeyFrameId id,
                                          const Camera& camera, const MapperSettings& settings) {
  const KeyFrame& keyframe = *map.Find(id);
  std::vector<const KeyFrame*> targets;
  for (const Neighbour& n : keyframe.covisible) {
    if (static_cast<int>(targets.size()) >= settings.fuse_keyframes) break;
    if (const KeyFrame* target = map.Find(n.id)) targets.push_back(target);
  }
  // Into each neighbour, and (the last one) all of theirs into this keyframe.
  std::vector<std::vector<FusedSighting>> found(targets.size() + 1);
  ParallelFor(static_cast<int>(found.size()), [&](int i) {
    if (i < static_cast<int>(targets.size())) {
      FindIn(map, keyframe.landmarks, *targets[i], camera, settings, found[i]);
      return;
    }
    std::vector<LandmarkId> theirs;
    for (const KeyFrame* target : targets) {
      theirs.insert(theirs.end(), target->landmarks.begin(), target->landmarks.end());
    }
    std::sort(theirs.begin(), theirs.end());
    theirs.erase(std::unique(theirs.begin(), theirs.end()), theirs.end());
    FindIn(map, theirs, keyframe, camera, settings, found[i]);
  });
  std::vector<FusedSighting> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
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
