// The depth images of a result at its final poses: the recording is read again.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "alidade/run/export/map_scale.h"
#include "alidade/run/export/training_images.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/surface/dense_view.h"

namespace alidade {

struct DenseViewSettings {
  int part = 0;                               // of the map, see PartsOf()
  int every = 0;                              // 0: keyframes; N: each N-th frame with a pose
  std::optional<std::string> source, camera;  // instead of those of the run
  bool color = false;
  std::optional<KnownDistance> scale_by;  // of maps of one camera: lengths are then meters
};

// What is known of the world of the views, which is that of the result's files (trajectory.txt).
struct ViewWorld {
  bool meters = false;
  std::optional<Eigen::Vector3d> up;  // against gravity, unit vector; nullopt: unknown
  double up_sigma = 0;                // standard deviation of its direction, radians; 0: unknown
  std::vector<Se3> path;              // T_world_camera of the views, as mounted
};

enum class DepthKind { kSensor, kStereo, kSemiDense };

struct ViewSummary {
  DepthKind kind = DepthKind::kSensor;
  double inverse_sigma = 0;  // of the views' depth, see DenseView
  int views = 0;
  int without = 0;  // keyframes or frames that were not found, or have no depth
  ViewWorld world;
};

// Calls `take` for each view, in order of time, in the calling thread. `path`: a result folder or a
// map. Depth is that of the sensor, or of stereo matching; of one camera the depth images that a
// run with --semidense wrote. Throws Error: input if there is no depth, or the recording is not
// known, gone or another; usage for a part that does not exist; ExportStopped.
ViewSummary ForEachDenseView(const std::string& path, const SavedMap& saved,
                             const DenseViewSettings& settings, const ExportProgress& progress,
                             const std::function<void(const DenseView&)>& take);

}  // namespace alidade
