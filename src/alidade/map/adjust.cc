#include "alidade/map/adjust.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "alidade/base/id_map.h"
#include "alidade/base/median.h"
#include "alidade/map/adjust_motion.h"
#include "alidade/map/view.h"
#include "alidade/optimize/bundle_covariance.h"
#include "alidade/optimize/pose_only.h"

namespace alidade {
namespace {

// Measured noise divided by the assumed one; the median of chi² with 2 degrees of freedom is 2
// ln 2. A value above 1 means that the state is not near the optimum.
double NoiseShare(const BundleProblem& problem, int cameras) {
  const double median_of_chi2 = 2 * std::numbers::ln2;
  std::vector<double> chi2;
  chi2.reserve(problem.observations.size());
  for (const BundleObservation& o : problem.observations) {
    if (o.camera >= cameras) continue;  // virtual observation, see AssumeDepth()
    chi2.push_back(
        ChiSquared(problem.camera, problem.T_camera_world[o.camera], problem.points[o.point], o));
  }
  if (chi2.empty()) return 1;
  return std::sqrt(UpperMedian(chi2) / median_of_chi2);
}

double Gate(const BundleObservation& o) { return std::isnan(o.pixel.z()) ? 5.991 : 7.815; }

// True if the depth is poorly observable: all rays to the landmark are within `degrees` of the
// reference keyframe's.
bool HasNoParallax(const MapSnapshot& map, const Landmark& landmark, const KeyFrame& reference,
                   double degrees) {
  const double least_cosine = std::cos(degrees * std::numbers::pi / 180);
  const Eigen::Vector3d ray = (landmark.p_world - reference.Centre()).normalized();
  return std::all_of(
      landmark.observations.begin(), landmark.observations.end(), [&](const Observation& o) {
        const KeyFrame* other = map.Find(o.keyframe);
        return !other || (landmark.p_world - other->Centre()).normalized().dot(ray) > least_cosine;
      });
}

// Virtual fixed cameras, one beside each keyframe, offset to the right by its median depth.
struct BesideCameras {
  IdMap<KeyFrameId, int> index;
  int Of(const MapSnapshot& map, const KeyFrame& keyframe, BundleProblem& problem) {
    if (const int* known = index.Find(keyframe.id)) return *known;
    Se3 T = keyframe.T_camera_world;
    T.t.x() -= MedianDepth(map, keyframe).value_or(1);
    problem.T_camera_world.push_back(T);
    problem.fixed.push_back(1);
    return index[keyframe.id] = static_cast<int>(problem.T_camera_world.size()) - 1;
  }
};

// Depth prior of the problem's last point at its current depth z in the reference keyframe, with
// standard deviation z × `error`. Implemented as an observation in a virtual camera beside the
// keyframe: disparity d = f b / z, so for a baseline b near z the standard deviation is σ_d = d σ_z
// / z = f × error.
void AssumeDepth(const MapSnapshot& map, const KeyFrame& reference, double error,
                 BesideCameras& beside, BundleProblem& problem) {
  const int camera = beside.Of(map, reference, problem);
  const Eigen::Vector3d p = problem.T_camera_world[camera] * problem.points.back();
  if (!(p.z() > 0)) return;
  const Eigen::Vector2d pixel = problem.camera.Project(p);
  const double sigma = error * problem.camera.fx;
  problem.observations.push_back({camera,
                                  static_cast<int>(problem.points.size()) - 1,
                                  {pixel.x(), pixel.y(), std::numeric_limits<double>::quiet_NaN()},
                                  1 / (sigma * sigma)});
}

// Of camera `newest` relative to camera `anchor`, the only one held: `cameras` and all points are
// unknown. Virtual observations are left out. Zero: not determined.
Matrix6d CovarianceOf(BundleProblem problem, const BundleSettings& settings, int cameras,
                      int newest, int anchor) {
  std::erase_if(problem.observations,
                [&](const BundleObservation& o) { return o.camera >= cameras; });
  problem.motion = {};
  problem.T_camera_world.resize(cameras);
  problem.fixed.assign(cameras, 0);
  problem.fixed[anchor] = 1;
  return CameraCovariance(problem, settings, newest).value_or(Matrix6d::Zero());
}

double LengthOfMotions(const BundleProblem& problem) {
  double length = 0;
  for (const BundleMotionLink& link : problem.motion.links) {
    const auto centre = [&](int state) {
      return problem.T_camera_world[problem.motion.states[state].camera].Inverse().t;
    };
    length += (centre(link.to) - centre(link.from)).norm();
  }
  return length;
}

// All lengths grow by `factor` about the center of camera `held`.
void Grow(BundleProblem& problem, int held, double factor) {
  const Eigen::Vector3d origin = problem.T_camera_world[held].Inverse().t;
  for (Se3& T : problem.T_camera_world) {
    const Eigen::Vector3d centre = origin + factor * (T.Inverse().t - origin);
    T.t = -(T.R * centre);
  }
  for (Eigen::Vector3d& p : problem.points) p = origin + factor * (p - origin);
}

// Adjusts, and keeps the length of the path where one camera's motions are measured and a single
// keyframe is held: the scale as a whole is that of the fit over the trajectory, which knows of the
// errors that poses have in common (decision 0036-tight-coupling). Here they may shrink it.
BundleReport Adjust(BundleProblem& problem, const BundleSettings& settings, bool keep_length,
                    int held, const std::atomic<bool>* stop) {
  const double before = LengthOfMotions(problem);
  const BundleReport report = AdjustBundle(problem, settings, stop);
  const double after = LengthOfMotions(problem);
  if (keep_length && before > 0 && after > 0) Grow(problem, held, before / after);
  return report;
}

// A keyframe that an adjustment moved: p_world_new = T_new_old p_world_old for what it sees.
struct MovedKeyFrame {
  KeyFrameId id;
  Se3 T_new_old;
};

// `moved`: by id.
std::optional<Se3> CorrectionOf(const std::vector<MovedKeyFrame>& moved, KeyFrameId id) {
  const auto at =
      std::lower_bound(moved.begin(), moved.end(), id,
                       [](const MovedKeyFrame& entry, KeyFrameId key) { return entry.id < key; });
  if (at == moved.end() || at->id != id) return {};
  return at->T_new_old;
}

// Pose of a keyframe that was inserted while the adjustment ran, as tracking would find it now. An
// adjustment takes errors off the poses of its keyframes that this one does not share, because it
// was placed by landmarks: following its parent, it would get them with the opposite sign. `start`:
// as if it followed; returned if the adjustment did not move its landmarks.
Se3 PoseByLandmarks(const MapCommit& commit, const MapSnapshot& base, const KeyFrame& young,
                    const Se3& start, const Adjustment& result) {
  constexpr int kLeast = 10;  // landmarks: 20 numbers for 6 unknowns, so that outliers are found
  std::vector<PoseMatch> matches;
  int adjusted = 0;
  for (size_t i = 0; i < young.landmarks.size(); ++i) {
    const LandmarkId id = young.landmarks[i];
    const Landmark* landmark =
        id.valid() && id.value < base.next_landmark() ? commit.Find(id) : nullptr;
    if (!landmark) continue;
    const Measurement m = Measure(young.frame->keypoints[i], result.noise);
    matches.push_back({landmark->p_world, m.pixel, m.inv_sigma2, m.inv_sigma2_right,
                       landmark->static_probability});
    adjusted += std::binary_search(
        result.points.begin(), result.points.end(), std::pair(id, Eigen::Vector3d()),
        [](const auto& one, const auto& other) { return one.first < other.first; });
  }
  if (adjusted < kLeast) return start;
  const PoseOnlyResult placed = OptimizePose(result.camera, start, matches);
  return placed.inliers < kLeast ? start : placed.T_camera_world;
}

}  // namespace

Adjustment AdjustKeyFrames(const MapSnapshot& map, const std::vector<KeyFrameId>& free,
                           const std::vector<KeyFrameId>& fixed, const Camera& camera,
                           const AdjustSettings& settings, const std::atomic<bool>* stop,
                           KeyFrameId newest) {
  BundleProblem problem;
  problem.camera = camera;
  IdMap<KeyFrameId, int> camera_index;
  std::vector<KeyFrameId> cameras;
  std::vector<const KeyFrame*> keyframes;
  for (const auto* set : {&free, &fixed}) {
    for (KeyFrameId id : *set) {
      camera_index[id] = static_cast<int>(problem.T_camera_world.size());
      keyframes.push_back(map.Find(id));
      problem.T_camera_world.push_back(keyframes.back()->T_camera_world);
      problem.fixed.push_back(set == &fixed);
      cameras.push_back(id);
    }
  }
  std::vector<LandmarkId> landmarks;
  for (KeyFrameId id : free) {
    for (LandmarkId landmark : map.Find(id)->landmarks) {
      if (landmark.valid()) landmarks.push_back(landmark);
    }
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());

  const bool one_camera = camera.StereoBaseline() <= 0;
  BesideCameras beside;
  std::vector<LandmarkId> points;
  for (LandmarkId id : landmarks) {
    const Landmark* landmark = map.Find(id);
    if (!landmark) continue;
    const int point = static_cast<int>(points.size());
    for (const Observation& o : landmark->observations) {
      const int* index = camera_index.Find(o.keyframe);
      if (!index) continue;
      const Measurement m =
          Measure(keyframes[*index]->frame->keypoints[o.keypoint], settings.noise);
      problem.observations.push_back(
          {*index, point, m.pixel, m.inv_sigma2, m.inv_sigma2_right, landmark->static_probability});
    }
    points.push_back(id);
    problem.points.push_back(landmark->p_world);
    if (!one_camera || !landmark->depth_assumed || settings.assumed_depth_error == 0) continue;
    const KeyFrame* reference = map.Find(landmark->reference);
    if (reference && HasNoParallax(map, *landmark, *reference, settings.assumed_depth_degrees))
      AssumeDepth(map, *reference, settings.assumed_depth_error, beside, problem);
  }

  Adjustment result;
  result.camera = camera;
  result.noise = settings.noise;
  BundleSettings bundle = settings.bundle;
  problem.motion = MotionBetween(map, cameras, !one_camera, one_camera && fixed.size() > 1);
  if (one_camera || !problem.motion.links.empty()) {
    const double measured = NoiseShare(problem, static_cast<int>(cameras.size()));
    WeighBy(measured, problem.motion);
    if (one_camera) {
      const double share = std::clamp(measured, settings.min_noise_ratio, 1.0);
      bundle.huber_mono *= share;
      bundle.redescending = bundle.redescending || share < 1;
    }
  }
  result.report =
      Adjust(problem, bundle, one_camera && fixed.size() == 1, static_cast<int>(free.size()), stop);
  for (size_t i = 0; i < free.size(); ++i)
    result.poses.push_back({free[i], problem.T_camera_world[i]});
  for (size_t i = 0; i < points.size(); ++i)
    result.points.push_back({points[i], problem.points[i]});
  for (const BundleObservation& o : problem.observations) {
    if (o.camera >= static_cast<int>(cameras.size())) continue;  // virtual observation
    const double chi2 =
        ChiSquared(camera, problem.T_camera_world[o.camera], problem.points[o.point], o);
    if (chi2 > Gate(o)) result.outliers.push_back({points[o.point], cameras[o.camera]});
  }
  const int* index = newest.valid() ? camera_index.Find(newest) : nullptr;
  if (kCovariances && index && !(stop && *stop)) {
    const auto oldest = std::min_element(cameras.begin(), cameras.end()) - cameras.begin();
    result.newest = newest;
    result.covariance = CovarianceOf(std::move(problem), bundle, static_cast<int>(cameras.size()),
                                     *index, static_cast<int>(oldest));
  }
  return result;
}

void CommitAdjustment(MapCommit& commit, const MapSnapshot& base, const Adjustment& result) {
  std::vector<MovedKeyFrame> moved;
  for (const auto& [id, T_camera_world] : result.poses) {
    KeyFrame* keyframe = commit.Edit(id);
    if (!keyframe) continue;
    moved.push_back({id, T_camera_world.Inverse() * keyframe->T_camera_world});
    keyframe->T_camera_world = T_camera_world;
  }
  if (KeyFrame* newest = result.newest.valid() ? commit.Edit(result.newest) : nullptr)
    newest->covariance = result.covariance;
  for (const auto& [id, p_world] : result.points) {
    if (Landmark* landmark = commit.Edit(id)) landmark->p_world = p_world;
  }
  for (uint32_t i = base.next_keyframe(); i < commit.next_keyframe(); ++i) {
    const KeyFrame* young = commit.Find(KeyFrameId{i});
    if (!young) continue;
    const Se3 before = young->T_camera_world;
    const Se3 start = before * CorrectionOf(moved, young->parent).value_or(Se3()).Inverse();
    const Se3 after = PoseByLandmarks(commit, base, *young, start, result);
    moved.push_back({young->id, after.Inverse() * before});
    commit.Edit(young->id)->T_camera_world = after;
  }
  for (uint32_t i = base.next_landmark(); i < commit.next_landmark(); ++i) {
    const Landmark* young = commit.Find(LandmarkId{i});
    const std::optional<Se3> T = young ? CorrectionOf(moved, young->reference) : std::nullopt;
    if (T) commit.Edit(young->id)->p_world = *T * young->p_world;
  }
  for (const auto& [landmark, keyframe] : result.outliers)
    commit.RemoveObservation(landmark, keyframe);
}

}  // namespace alidade
