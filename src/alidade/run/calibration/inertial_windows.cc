#include "alidade/run/calibration/inertial_windows.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "alidade/base/degrees.h"
#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/inertial/rotation_match.h"

namespace alidade {
namespace {

constexpr double kSpacing = 0.09;    // seconds between poses that are fitted
constexpr double kGap = 0.5;         // seconds: a window ends
constexpr double kMargin = 0.3;      // seconds of readings beside the poses
constexpr size_t kFewestPoses = 16;  // of a window

std::string Figures(const char* format, double a, double b) {
  char text[160];
  PrintTo(text, sizeof(text), format, a, b);
  return text;
}

std::vector<std::vector<TimedPose>> WindowsOf(const Trajectory& trajectory,
                                              const WindowSettings& settings) {
  const Matrix6d errors = CommonErrors(settings.distance);
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
    timed.covariance = errors;
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

// Mean of estimates with a prior of zero in each, which counts once: estimates x with standard
// deviations s have the information 1/s² - 1/prior² of their own.
struct WithPrior {
  double prior;  // standard deviation; infinite: none
  double weight = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();

  void Add(const Eigen::Vector3d& x, double sigma) {
    const double w = 1 / std::pow(std::max(sigma, 1e-6), 2);
    weight += std::max(0.0, w - 1 / (prior * prior));
    sum += w * x;
  }
  double Total() const { return weight + 1 / (prior * prior); }
  Eigen::Vector3d Mean() const { return sum / Total(); }
};

// Of the sensor: rotation, place and clock.
void MergeModels(const std::vector<InertialFit>& fits, const ImuModel& given,
                 InertialFinding& finding) {
  const InertialPriors priors;
  finding.model = given;
  const Eigen::Matrix3d R = fits.front().model.T_camera_imu.R;
  WithPrior turn{INFINITY}, place{priors.translation}, offset{priors.time_offset};
  const auto offset_of = [&](const InertialFit& fit) -> Eigen::Vector3d {
    return {fit.model.time_offset - given.time_offset, 0, 0};
  };
  for (const InertialFit& fit : fits) {
    turn.Add(LogSo3(R.transpose() * fit.model.T_camera_imu.R), fit.rotation_sigma);
    place.Add(fit.model.T_camera_imu.t, fit.translation_sigma);
    offset.Add(offset_of(fit), fit.time_offset_sigma);
  }
  finding.model.T_camera_imu = {R * ExpSo3(turn.Mean()), place.Mean()};
  finding.model.time_offset = given.time_offset + offset.Mean().x();
  double of_turn = 0, of_place = 0, of_offset = 0;
  for (const InertialFit& fit : fits) {
    const auto square = [](double length, double sigma, int size) {
      return std::pow(length / std::max(sigma, 1e-6), 2) / size;
    };
    of_turn += square(RotationAngle(fit.model.T_camera_imu, finding.model.T_camera_imu),
                      fit.rotation_sigma, 3);
    of_place += square((fit.model.T_camera_imu.t - finding.model.T_camera_imu.t).norm(),
                       fit.translation_sigma, 3);
    of_offset +=
        square(fit.model.time_offset - finding.model.time_offset, fit.time_offset_sigma, 1);
  }
  const Weighted all{fits};
  finding.rotation_sigma = std::sqrt(all.Inflated(of_turn) / turn.Total());
  finding.translation_sigma = std::sqrt(all.Inflated(of_place) / place.Total());
  finding.time_offset_sigma = std::sqrt(all.Inflated(of_offset) / offset.Total());
  if (given.rotation_known) finding.rotation_sigma = 0;
  if (given.translation_known) finding.translation_sigma = 0;
  if (given.time_offset_known) finding.time_offset_sigma = 0;
}

void MergeBiases(const std::vector<InertialFit>& fits, InertialFinding& finding) {
  const auto count = static_cast<double>(fits.size());
  Vector6d mean = Vector6d::Zero(), square = mean;
  for (const InertialFit& fit : fits) {
    Vector6d bias;
    bias << fit.states.back().bias.gyro, fit.states.back().bias.accel;
    mean += bias / count;
    square += bias.cwiseProduct(bias) / count;
  }
  finding.bias = {mean.head<3>(), mean.tail<3>()};
  constexpr size_t kFewestWindows = 2;
  if (fits.size() < kFewestWindows) return;
  finding.bias_sigma =
      (square - mean.cwiseProduct(mean)).cwiseMax(0).cwiseSqrt() / std::sqrt(count - 1);
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
    turning += match.Tells();
    if (match.Contradicts()) {
      ++contradicting;
      continue;
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
  } else if (!(finding.down_sigma < kMostGravitySigma)) {
    finding.why_not = "gravity is not observable: its direction is known to " +
                      Figures("%.1f degrees only (at most %.1f)", kDegrees * finding.down_sigma,
                              kDegrees * kMostGravitySigma);
  }
  return finding;
}

}  // namespace alidade
