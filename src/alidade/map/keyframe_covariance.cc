#include "alidade/map/keyframe_covariance.h"

#include "alidade/base/id_map.h"
#include "alidade/base/median.h"
#include "alidade/map/view.h"
#include "alidade/optimize/bundle_covariance.h"

namespace alidade {

std::vector<std::pair<KeyFrameId, Matrix6d>> KeyFrameCovariances(const MapSnapshot& snapshot,
                                                                 MapId map, const Camera& camera,
                                                                 const MeasurementNoise& noise) {
  BundleProblem problem;
  problem.camera = camera;
  const std::vector<KeyFrameId> ids = snapshot.KeyFramesOf(map);
  IdMap<KeyFrameId, int> index;
  std::vector<double> depths;
  for (const KeyFrameId id : ids) {
    const KeyFrame& keyframe = *snapshot.Find(id);
    index[id] = static_cast<int>(problem.T_camera_world.size());
    problem.T_camera_world.push_back(keyframe.T_camera_world);
    if (const auto depth = MedianDepth(snapshot, keyframe)) depths.push_back(*depth);
  }
  if (depths.empty()) return {};
  problem.fixed.assign(ids.size(), 0);
  for (const LandmarkId id : snapshot.Landmarks()) {
    const Landmark& landmark = *snapshot.Find(id);
    const int point = static_cast<int>(problem.points.size());
    const size_t before = problem.observations.size();
    for (const Observation& o : landmark.observations) {
      const int* at = index.Find(o.keyframe);
      if (!at) continue;
      const Measurement m = Measure(snapshot.Find(o.keyframe)->frame->keypoints[o.keypoint], noise);
      problem.observations.push_back(
          {*at, point, m.pixel, m.inv_sigma2, m.inv_sigma2_right, landmark.static_probability});
    }
    if (problem.observations.size() > before) problem.points.push_back(landmark.p_world);
  }
  const std::vector<Matrix6d> covariances = CameraCovariances(problem, {}, UpperMedian(depths));
  std::vector<std::pair<KeyFrameId, Matrix6d>> known;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (!covariances[i].isZero()) known.emplace_back(ids[i], covariances[i]);
  }
  return known;
}

}  // namespace alidade
