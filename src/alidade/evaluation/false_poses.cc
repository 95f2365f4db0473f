#include "alidade/evaluation/false_poses.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/evaluation/matched.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Matched {
  Se3 truth, estimate;
};

// R that minimizes the sum of |R R_estimate - R_truth|² (Frobenius); the rotation part of Umeyama
// 1991.
Matrix3d TurnBetween(const std::vector<Matched>& poses) {
  Matrix3d sum = Matrix3d::Zero();
  for (const Matched& pose : poses) sum += pose.truth.R * pose.estimate.R.transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

struct Lengths {
  double truth = 0, estimate = 0;  // meters; in the estimate's unit
};

// Path length from pose `first` up to, excluding, pose `last`, in steps of at least `step` meters
// of the truth.
Lengths Walk(const std::vector<Matched>& poses, size_t first, size_t last, double step) {
  Lengths sum;
  size_t from = first;
  for (size_t i = first; i < last; ++i) {
    const double length = (poses[i].truth.t - poses[from].truth.t).norm();
    if (length < step) continue;
    sum.truth += length;
    sum.estimate += (poses[i].estimate.t - poses[from].estimate.t).norm();
    from = i;
  }
  return sum;
}

double ScaleDrift(const std::vector<Matched>& poses, double step) {
  const size_t count = poses.size(), third = count / 3;
  const Lengths first = Walk(poses, 0, third, step), last = Walk(poses, count - third, count, step);
  if (!(first.estimate > 0 && last.estimate > 0)) return std::numeric_limits<double>::quiet_NaN();
  return (last.truth / last.estimate) / (first.truth / first.estimate);
}

double PathOf(const std::vector<Matched>& poses, double step) {
  double reach = 0;
  for (const Matched& pose : poses)
    reach = std::max(reach, (pose.truth.t - poses.front().truth.t).norm());
  return std::max(reach, Walk(poses, 0, poses.size(), step).truth);
}

}  // namespace

void FalsePoseSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("false poses: ") + what);
  };
  require(share_of_path > 0 && std::isfinite(share_of_path), "the share of the path must be > 0");
  require(degrees > 0 && degrees <= 180, "degrees must be between 0 and 180");
  require(step > 0 && std::isfinite(step), "the step must be a positive number of meters");
  require(max_dt > 0, "max_dt must be a positive number of seconds");
}

FalsePoses FindFalsePoses(const Trajectory& truth, const Trajectory& estimate, Alignment align,
                          const FalsePoseSettings& settings) {
  settings.Check();
  FalsePoses found;
  found.scale_drift = std::numeric_limits<double>::quiet_NaN();
  if (truth.empty() || estimate.empty()) return found;
  const TimeOrder truth_order = OrderByTime(truth, "truth");
  const TimeOrder estimate_order = OrderByTime(estimate, "estimate");
  for (const StampPair& pair : AssociateStamps(truth_order.stamps, estimate_order.stamps,
                                               settings.max_dt, Association::kTum)) {
    found.pairs.push_back({truth_order.index[static_cast<size_t>(pair.truth)],
                           estimate_order.index[static_cast<size_t>(pair.estimate)]});
  }
  if (found.pairs.size() < 3) return found;
  std::vector<Matched> poses;
  for (const StampPair& pair : found.pairs)
    poses.push_back({truth[static_cast<size_t>(pair.truth)].T_world_camera,
                     estimate[static_cast<size_t>(pair.estimate)].T_world_camera});
  found.path = PathOf(poses, settings.step);
  found.scale_drift = ScaleDrift(poses, settings.step);
  const Matrix3d turn = TurnBetween(poses);
  Sim3 T_truth_estimate;
  try {
    T_truth_estimate = AlignTrajectories(truth, estimate, found.pairs, align);
  } catch (const Error&) {  // all poses of one trajectory are at one point
    T_truth_estimate = {0, turn, Vector3d::Zero()};
    for (const Matched& pose : poses)
      T_truth_estimate.t += pose.truth.t / static_cast<double>(poses.size());
  }
  std::vector<double> metres, degrees;
  for (size_t i = 0; i < poses.size(); ++i) {
    const Matched& pose = poses[i];
    metres.push_back((pose.truth.t - T_truth_estimate * pose.estimate.t).norm());
    const Se3 turned{turn * pose.estimate.R, Vector3d::Zero()};
    degrees.push_back(RotationAngle(pose.truth, turned) * 180 / std::numbers::pi);
    const bool moved = found.path > 0;
    if ((moved && metres.back() > settings.share_of_path * found.path) ||
        degrees.back() > settings.degrees)
      found.wrong.push_back(found.pairs[i].estimate);
  }
  std::sort(found.wrong.begin(), found.wrong.end());
  found.metres = DescribeErrors(std::move(metres));
  found.degrees = DescribeErrors(std::move(degrees));
  return found;
}

}  // namespace alidade
