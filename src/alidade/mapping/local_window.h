// The part of the map that a new keyframe can improve, as a bundle adjustment problem and back.
#pragma once

#include <atomic>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/settings.h"

namespace alidade {

struct WindowResult {
  std::vector<std::pair<KeyFrameId, Se3>> poses;               // T_camera_world, adjusted
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;  // adjusted
  std::vector<std::pair<LandmarkId, KeyFrameId>> outliers;     // observations that do not fit
  BundleReport report;
};

// Adjusts `id`, its best covisible keyframes and all they see; keyframes that see the same
// landmarks from outside hold the gauge (ORB-SLAM §VI-D). `map` is not changed. `stop` may be null.
WindowResult AdjustWindow(const MapSnapshot& map, KeyFrameId id, const Camera& camera,
                          const MapperSettings& settings, const std::atomic<bool>* stop);
// The same for a given set of keyframes: `free` adjusted, `fixed` held.
WindowResult AdjustKeyFrames(const MapSnapshot& map, const std::vector<KeyFrameId>& free,
                             const std::vector<KeyFrameId>& fixed, const Camera& camera,
                             const MapperSettings& settings, const std::atomic<bool>* stop);

// Enters the result object by object, where it still lives. What was born since `base` follows:
// keyframes their parent, landmarks their reference keyframe.
void CommitWindow(MapCommit& commit, const MapSnapshot& base, const WindowResult& result);

}  // namespace alidade
