#include "alidade/map/keyframe_covariance.h"

#include "alidade/base/id_map.h"
#include "alidade/base/median.h"
#include "alidade/map/view.h"
#include "alidade/optimize/bundle_covariance.h"

namespace alidade {
namespace {

// Multiplications of a factorization: 2 to 5 s in all.
constexpr double kMostWork = 3e9;

// The keyframes `ids` and all that they observe.
BundleProblem ProblemOf(const MapSnapshot& snapshot, const std::vector<KeyFrameId>& ids,
                        const Camera& camera, const MeasurementNoise& noise) {
  BundleProblem problem;
  problem.camera = camera;
  IdMap<KeyFrameId, int> index;
  for (const KeyFrameId id : ids) {
    index[id] = static_cast<int>(problem.T_camera_world.size());
    problem.T_camera_world.push_back(snapshot.Find(id)->T_camera_world);
  }
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
  return problem;
}

}  // namespace

std::vector<std::pair<KeyFrameId, Matrix6d>> KeyFrameCovariances(const MapSnapshot& snapshot,
                                                                 MapId map, const Camera& camera,
                                                                 const MeasurementNoise& noise) {
  const std::vector<KeyFrameId> all = snapshot.KeyFramesOf(map);
  std::vector<double> depths;
  for (const KeyFrameId id : all) {
    if (const auto depth = MedianDepth(snapshot, *snapshot.Find(id))) depths.push_back(*depth);
  }
  if (depths.empty()) return {};
  const double depth = UpperMedian(depths);

  // Of a large map every second, fourth, … keyframe stands for those after it.
  std::vector<KeyFrameId> ids;
  std::vector<Matrix6d> covariances;
  size_t step = 1;
  for (;; step *= 2) {
    ids.clear();
    for (size_t i = 0; i < all.size(); i += step) ids.push_back(all[i]);
    if (ids.size() < 2) return {};
    covariances = CameraCovariances(ProblemOf(snapshot, ids, camera, noise), {}, depth, kMostWork);
    if (!covariances.empty()) break;
  }
  std::vector<std::pair<KeyFrameId, Matrix6d>> known;
  for (size_t i = 0; i < all.size(); ++i) {
    const Matrix6d& covariance = covariances[i / step];
    if (covariance.isZero()) continue;
    const Se3 T_this_solved = snapshot.Find(all[i])->T_camera_world *
                              snapshot.Find(ids[i / step])->T_camera_world.Inverse();
    known.emplace_back(all[i], Carried(T_this_solved, covariance) / static_cast<double>(step));
  }
  return known;
}

}  // namespace alidade
