// Part of the map as a bundle adjustment problem, and back.
#pragma once

#include <atomic>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"
#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

struct AdjustSettings {
  MeasurementNoise noise;  // of keypoints
  BundleSettings bundle;
};

struct Adjustment {
  std::vector<std::pair<KeyFrameId, Se3>> poses;               // T_camera_world, by id
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;  // adjusted
  std::vector<std::pair<LandmarkId, KeyFrameId>> outliers;     // observations that do not fit
  BundleReport report;
};

// Adjusts `free` and all they see, `fixed` held; both sorted. `map` is not changed. `stop` (may be
// null) cuts it short.
Adjustment AdjustKeyFrames(const MapSnapshot& map, const std::vector<KeyFrameId>& free,
                           const std::vector<KeyFrameId>& fixed, const Camera& camera,
                           const AdjustSettings& settings, const std::atomic<bool>* stop);

// Enters the result object by object, where it still lives. What was born since `base` follows:
// keyframes their parent, landmarks their reference keyframe.
void CommitAdjustment(MapCommit& commit, const MapSnapshot& base, const Adjustment& result);

}  // namespace alidade
