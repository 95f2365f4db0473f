#include "alidade/run/world/inertial_windows.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/inertial/rotation_match.h"

namespace alidade {
namespace {

constexpr double kSpacing = 0.09;    // seconds between poses that are fitted
constexpr double kGap = 0.5;         // seconds: a window ends
constexpr double kMargin = 0.3;      // seconds of readings beside the poses
constexpr size_t kFewestPoses = 16;  // of a window
// Errors that poses of a map have in common, as in system/inertial.
constexpr double kPoseRotation = 7e-4;                            // radians
constexpr double kPosePosition = 1.5e-3;                          // of the distance of what is seen
constexpr double kMostNoiseFactor = 6;                            // above, the model is wrong
constexpr double kMostScaleSigma = 0.05, kMostDownSigma = 0.035;  // relative, radians
constexpr double kTurningRate = 0.1;                              // rad/s

std::string Figures(const char* format, double a, double b) {
  char text[160];
  PrintTo(text, sizeof(text), format, a, b);
  return text;
}

std::vector<std::vector<TimedPose>> WindowsOf(const Trajectory& trajectory,
                                              const WindowSettings& settings) {
  Vector6d errors;
  errors << Eigen::Vector3d::Constant(std::pow(kPosePosition * settings.distance, 2)),
      Eigen::Vector3d::Constant(kPoseRotation * kPoseRotation);
  // Windows of equal length, each not longer than asked for.
  std::vector<std::vector<TimedPose>> stretches, windows;
  double last = -1e300;
  for (const StampedPose& pose : trajectory) {
    if (pose.time - last > kGap) stretches.emplace_back();
    const bool first = stretches.back().empty();
    last = pose.time;
    if (!first && pose.time - stretches.back().back().time < kSpacing) continue;
    TimedPose timed;
    timed.time = pose.time;
    timed.T_world_camera = pose.T_world_camera;
    timed.covariance = errors.asDiagonal();
    stretches.back().push_back(timed);
  }
  for (const std::vector<TimedPose>& stretch : stretches) {
    if (stretch.size() < kFewestPoses) continue;
    const double span = stretch.back().time - stretch.front().time;
    const auto count = static_cast<size_t>(std::max(1.0, std::ceil(span / settings.seconds)));
    for (size_t k = 0; k < count; ++k) {
      const size_t from = k * stretch.size() / count, to = (k + 1) * stretch.size() / count;
      if (to - from < kFewestPoses) continue;
      windows.emplace_back(stretch.begin() + static_cast<long>(from),
                           stretch.begin() + static_cast<long>(to));
    }
  }
  return windows;
}

struct Weighted {
  std::vector<InertialFit> fits;

  // Mean of log scale by inverse variance; the standard deviation is that of the sum, or that of
  // the scatter if it is larger.
  void Scale(InertialFinding& finding) const {
    double weight = 0, sum = 0, scatter = 0;
    for (const InertialFit& fit : fits) {
      const double w = 1 / (fit.scale_sigma * fit.scale_sigma);
      weight += w;
      sum += w * std::log(fit.scale);
    }
    const double mean = sum / weight;
    for (const InertialFit& fit : fits)
      scatter += std::pow((std::log(fit.scale) - mean) / fit.scale_sigma, 2);
    finding.scale = std::exp(mean);
    finding.scale_sigma = std::sqrt(Inflated(scatter) / weight);
  }

  void Down(InertialFinding& finding) const {
    double weight = 0, scatter = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const InertialFit& fit : fits) {
      const double w = 1 / (fit.gravity_sigma * fit.gravity_sigma);
      weight += w;
      sum += w * fit.gravity.normalized();
    }
    finding.down = sum.normalized();
    for (const InertialFit& fit : fits) {
      // Two degrees of freedom each.
      scatter += (fit.gravity.normalized() - finding.down).squaredNorm() / 2 /
                 (fit.gravity_sigma * fit.gravity_sigma);
    }
    finding.down_sigma = std::sqrt(Inflated(scatter) / weight);
  }

  double Inflated(double scatter) const {
    return fits.size() < 2 ? 1 : std::max(1.0, scatter / static_cast<double>(fits.size() - 1));
  }
};

// Of the sensor: rotation, place and clock, as means by inverse variance.
void MergeModels(const std::vector<InertialFit>& fits, const ImuModel& given,
                 InertialFinding& finding) {
  finding.model = given;
  double of_offset = 0, of_turn = 0, of_place = 0, offset = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), turn = place;
  const Eigen::Matrix3d R = fits.front().model.T_camera_imu.R;
  for (const InertialFit& fit : fits) {
    const double a = 1 / std::pow(std::max(fit.time_offset_sigma, 1e-6), 2),
                 b = 1 / std::pow(std::max(fit.rotation_sigma, 1e-6), 2),
                 c = 1 / std::pow(std::max(fit.translation_sigma, 1e-6), 2);
    of_offset += a;
    of_turn += b;
    of_place += c;
    offset += a * fit.model.time_offset;
    turn += b * LogSo3(R.transpose() * fit.model.T_camera_imu.R);
    place += c * fit.model.T_camera_imu.t;
  }
  finding.model.time_offset = offset / of_offset;
  finding.model.T_camera_imu.R = R * ExpSo3(turn / of_turn);
  finding.model.T_camera_imu.t = place / of_place;
  double scatter_offset = 0, scatter_turn = 0, scatter_place = 0;
  for (const InertialFit& fit : fits) {
    scatter_offset += std::pow(
        (fit.model.time_offset - finding.model.time_offset) / std::max(fit.time_offset_sigma, 1e-6),
        2);
    scatter_turn +=
        LogSo3(finding.model.T_camera_imu.R.transpose() * fit.model.T_camera_imu.R).squaredNorm() /
        3 / std::pow(std::max(fit.rotation_sigma, 1e-6), 2);
    scatter_place += (fit.model.T_camera_imu.t - finding.model.T_camera_imu.t).squaredNorm() / 3 /
                     std::pow(std::max(fit.translation_sigma, 1e-6), 2);
  }
  const Weighted all{fits};
  finding.time_offset_sigma = std::sqrt(all.Inflated(scatter_offset) / of_offset);
  finding.rotation_sigma = std::sqrt(all.Inflated(scatter_turn) / of_turn);
  finding.translation_sigma = std::sqrt(all.Inflated(scatter_place) / of_place);
}

void MergeBiases(const std::vector<InertialFit>& fits, InertialFinding& finding) {
  finding.bias = fits.back().states.back().bias;
  if (fits.size() < 2) return;
  Vector6d mean = Vector6d::Zero(), square = mean;
  for (const InertialFit& fit : fits) {
    Vector6d bias;
    bias << fit.states.back().bias.gyro, fit.states.back().bias.accel;
    mean += bias / static_cast<double>(fits.size());
    square += bias.cwiseProduct(bias) / static_cast<double>(fits.size());
  }
  finding.bias_sigma = (square - mean.cwiseProduct(mean)).cwiseMax(0).cwiseSqrt();
}

}  // namespace

InertialFinding FindInertial(const Trajectory& trajectory, const std::vector<ImuSample>& samples,
                             const ImuModel& model, const WindowSettings& settings) {
  InertialFinding finding;
  finding.model = model;
  const std::vector<std::vector<TimedPose>> windows = WindowsOf(trajectory, settings);
  finding.windows = static_cast<int>(windows.size());
  if (windows.empty()) {
    finding.why_not =
        "the trajectory is too short: at least 1.5 s without a gap of half a second are needed";
    return finding;
  }
  InertialPriors priors;
  if (settings.meters) priors.scale = 0.01;
  Weighted all;
  int contradicting = 0, turning = 0;
  for (const std::vector<TimedPose>& poses : windows) {
    const auto at = [&](double time) {
      return std::lower_bound(
          samples.begin(), samples.end(), time,
          [](const ImuSample& sample, double wanted) { return sample.time < wanted; });
    };
    const double offset = model.time_offset;
    const auto from = at(poses.front().time + offset - kMargin),
               to = at(poses.back().time + offset + kMargin);
    const std::vector<ImuSample> some(from, to);
    if (some.size() < poses.size() || some.front().time > poses.front().time + offset + kMargin ||
        some.back().time < poses.back().time + offset - kMargin)
      continue;
    // The readings cover the poses whatever the offset turns out to be.
    std::vector<TimedPose> covered = poses;
    std::erase_if(covered, [&](const TimedPose& pose) {
      return pose.time + offset < some.front().time + 0.15 ||
             pose.time + offset > some.back().time - 0.15;
    });
    if (covered.size() < kFewestPoses) continue;
    const RotationMatch match = MatchRotations(covered, some, model);
    if (match.ok && match.turning > kTurningRate) {
      ++turning;
      if (match.residual > 0.5 * match.turning) {
        ++contradicting;
        continue;
      }
    }
    const InertialFit* start = all.fits.empty() ? nullptr : &all.fits.back();
    InertialFit fit = FitInertial(covered, some, model, priors, start);
    if (!fit.solved && start) fit = FitInertial(covered, some, model, priors);
    if (!fit.solved || !(fit.noise_factor < kMostNoiseFactor)) continue;
    finding.noise_factor = std::max(finding.noise_factor, fit.noise_factor);
    all.fits.push_back(std::move(fit));
  }
  finding.solved = static_cast<int>(all.fits.size());
  if (contradicting > 0 && 2 * contradicting > turning) {
    finding.why_not =
        "the gyroscope does not turn as the camera does: readings of another device, of another "
        "time, or stabilized images";
    return finding;
  }
  if (all.fits.empty()) {
    finding.why_not =
        "the readings do not explain the path, or do not cover it (are both on one "
        "clock?)";
    return finding;
  }
  all.Scale(finding);
  all.Down(finding);
  MergeModels(all.fits, model, finding);
  MergeBiases(all.fits, finding);
  if (!(finding.scale_sigma < kMostScaleSigma)) {
    finding.why_not = "the scale is not observable: it is known to " +
                      Figures("%.0f %% only (at most %.0f %%)", 100 * finding.scale_sigma,
                              100 * kMostScaleSigma) +
                      "; the camera moved too evenly. Start, stop and turn while recording";
  } else if (!(finding.down_sigma < kMostDownSigma)) {
    finding.why_not = "gravity is not observable: its direction is known to " +
                      Figures("%.1f degrees only (at most %.1f)", 57.29578 * finding.down_sigma,
                              57.29578 * kMostDownSigma);
  }
  return finding;
}

}  // namespace alidade
