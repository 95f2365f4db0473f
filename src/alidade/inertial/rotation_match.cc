#include "alidade/inertial/rotation_match.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>
#include <vector>

namespace alidade {
namespace {

constexpr double kUnknown = 1e3;  // standard deviation of what the rates do not tell

struct RatePair {
  Eigen::Vector3d camera, imu;  // rad/s
};

std::vector<RatePair> RatesAt(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                              double offset) {
  std::vector<RatePair> pairs;
  for (size_t k = 1; k < poses.size(); ++k) {
    const double from = poses[k - 1].time + offset, to = poses[k].time + offset;
    if (from < samples.front().time || to > samples.back().time || to <= from) continue;
    if (!TellMotion(samples, from, to)) continue;
    const Eigen::Matrix3d turn =
        poses[k - 1].T_world_camera.R.transpose() * poses[k].T_world_camera.R;
    pairs.push_back({LogSo3(turn) / (to - from), LogSo3(TurnOf(samples, from, to)) / (to - from)});
  }
  return pairs;
}

// Root mean square of the camera's rates, and of what the readings leave of them.
void MeasureResidual(std::span<const RatePair> pairs, RotationMatch& match) {
  double left = 0, turning = 0;
  for (const RatePair& pair : pairs) {
    left += (pair.camera - match.R_camera_imu * (pair.imu - match.gyro_bias)).squaredNorm();
    turning += pair.camera.squaredNorm();
  }
  match.residual = std::sqrt(left / static_cast<double>(pairs.size()));
  match.turning = std::sqrt(turning / static_cast<double>(pairs.size()));
}

RotationMatch MatchAt(std::span<const RatePair> pairs, const ImuModel& model, double offset) {
  RotationMatch match;
  match.time_offset = offset;
  if (pairs.size() < 4) return match;
  Eigen::Vector3d camera = Eigen::Vector3d::Zero(), imu = camera;
  for (const RatePair& pair : pairs) {
    camera += pair.camera;
    imu += pair.imu;
  }
  camera /= static_cast<double>(pairs.size());
  imu /= static_cast<double>(pairs.size());
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero(), moments = correlation;
  for (const RatePair& pair : pairs) {
    const Eigen::Vector3d rate = pair.camera - camera;
    correlation += rate * (pair.imu - imu).transpose();
    moments += rate * rate.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()(0) > 0)
    match.second_axis = svd.singularValues()(1) / svd.singularValues()(0);
  Eigen::Matrix3d& R = match.R_camera_imu;
  if (model.rotation_known) {
    R = model.T_camera_imu.R;
  } else {
    Eigen::Vector3d signs(1, 1, 1);
    signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  }
  match.gyro_bias = imu - R.transpose() * camera;
  MeasureResidual(pairs, match);
  if (!model.rotation_known) {
    // The information of rates w is the sum of |w|² I - w w'.
    const Eigen::Vector3d moment =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments, Eigen::EigenvaluesOnly)
            .eigenvalues();
    const double information = moment(0) + moment(1);
    match.rotation_sigma = information > 0 ? match.residual / std::sqrt(3 * information) : kUnknown;
  }
  match.ok = true;
  return match;
}

}  // namespace

RotationMatch CompareRotations(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                               const ImuModel& model, const Eigen::Vector3d& gyro_bias) {
  RotationMatch match;
  match.R_camera_imu = model.T_camera_imu.R;
  match.time_offset = model.time_offset;
  match.gyro_bias = gyro_bias;
  if (poses.size() < 2 || samples.size() < 2) return match;
  const std::vector<RatePair> pairs = RatesAt(poses, samples, model.time_offset);
  if (pairs.empty()) return match;
  MeasureResidual(pairs, match);
  match.ok = true;
  return match;
}

RotationMatch MatchRotations(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                             const ImuModel& model, double longest_offset) {
  if (poses.size() < 2 || samples.size() < 2) return {};
  const auto at = [&](double offset) {
    return MatchAt(RatesAt(poses, samples, offset), model, offset);
  };
  if (model.time_offset_known) return at(model.time_offset);
  constexpr double kStep = 0.01;  // seconds: half the shortest period of a hand is longer
  const int steps = static_cast<int>(std::lround(longest_offset / kStep));
  RotationMatch best;
  double before = 0, after = 0;  // squared residuals beside the best one
  double last = 0;
  bool best_is_last = false;
  for (int k = -steps; k <= steps; ++k) {
    const RotationMatch match = at(model.time_offset + k * kStep);
    if (!match.ok) continue;
    const double squared = match.residual * match.residual;
    if (best_is_last) after = squared;
    best_is_last = !best.ok || match.residual < best.residual;
    if (best_is_last) {
      best = match;
      before = last;
      after = 0;
    }
    last = squared;
  }
  if (!best.ok) return best;
  // The minimum of the parabola through the three squared residuals.
  const double middle = best.residual * best.residual;
  const double bend = before + after - 2 * middle;
  if (before > 0 && after > 0 && bend > 0) {
    const RotationMatch finer = at(best.time_offset + 0.5 * kStep * (before - after) / bend);
    if (finer.ok && finer.residual <= best.residual) best = finer;
    // Squared residuals are about m + (bend / 2) (offset / step)², of as many pairs as poses.
    best.time_offset_sigma =
        kStep * std::sqrt(2 * middle / (3 * static_cast<double>(poses.size()) * bend));
  } else {
    best.time_offset_sigma = kUnknown;
  }
  return best;
}

}  // namespace alidade
