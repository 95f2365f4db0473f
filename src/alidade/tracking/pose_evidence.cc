#include "alidade/tracking/pose_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "alidade/base/settings_table.h"

namespace alidade {
namespace {

// Of the noise of a frame's keypoints, relative to the nominal one: usual, soft, blurred.
struct Noise {
  double scale, share;
};
constexpr Noise kNoises[] = {{1, 0.7}, {1.7, 0.2}, {3, 0.1}};

// Of the errors of chance matches, in which the pose was fitted: fitting makes them smaller than
// they are anywhere in the window.
constexpr double kFitted = 3;

// Logarithm of the integral of exp(-e² / (2 s²)) over errors |e| up to the window.
double LogNorm(double s, double window2) {
  return std::log(2 * std::numbers::pi * s * s * -std::expm1(-0.5 * window2 / (s * s)));
}

double LogSum(double a, double b) {
  const double larger = std::max(a, b);
  return larger + std::log1p(std::exp(std::min(a, b) - larger));
}

}  // namespace

std::span<const Setting> PoseEvidenceSettings::Table() {
  using T = PoseEvidenceSettings;
  static constexpr Setting kRows[] = {
      ExpertSetting<&T::occluded>(
          "pose.occluded", kShareBelowOne, "",
          "Probability that a twelfth of the image does not show the map where the pose is right."),
      ExpertSetting<&T::look_alike>(
          "pose.look_alike", kShareBelowOne, "",
          "Probability that a twelfth of the image agrees with the map where the pose is wrong."),
      ExpertSetting<&T::jump_rate>("pose.jump_rate", kNotNegative, "1/s",
                                   "Rate of cuts in a recording: how soon a pose that follows from "
                                   "the last one is doubted."),
      ExpertSetting<&T::found_again>(
          "pose.found_again", kShareBelowOne, "",
          "Probability that a place found by appearance is right, before it is compared."),
      PublicSetting<&T::min_probability>("pose.min_probability", kShareBelowOne, "",
                                         "A frame whose pose is less probably right is lost."),
      ExpertSetting<&T::min_keyframe>(
          "pose.min_keyframe", kShareBelowOne, "",
          "A frame whose pose is less probably right does not become a keyframe, where "
          "pose.min_probability is lower."),
  };
  return kRows;
}

double LogOdds(double probability) { return std::log(probability / (1 - probability)); }

double Probability(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

double AfterSeconds(double before, double seconds, const PoseEvidenceSettings& settings) {
  const double stays = std::exp(-settings.jump_rate * std::max(seconds, 0.0));
  if (stays == 1) return before;
  const double p = stays * Probability(before);
  return std::log(p) - std::log1p(-p);
}

PoseEvidence::PoseEvidence(const Frame& frame, int width, int height, const MeasurementNoise& noise,
                           double window, bool disparities, const PoseEvidenceSettings& settings)
    : settings_(settings), width_(width), height_(height), window2_(window * window) {
  std::array<double, kPyramidLevels> on_level{};
  double count = 0, sum = 0, squares = 0, weight = 0;
  for (const Keypoint& keypoint : frame.keypoints) {
    ++on_level[keypoint.level];
    if (!disparities || !keypoint.has_depth()) continue;
    const double disparity = keypoint.x - keypoint.right_x;
    ++count;
    weight += Measure(keypoint, noise).inv_sigma2_right;
    sum += disparity;
    squares += disparity * disparity;
  }
  if (count > 1) {
    const double variance = squares / count - sum / count * (sum / count);
    disparity_spread2_ = std::max(0.0, variance) * weight / count;
  }
  const double area = std::numbers::pi * window2_;
  for (int level = 0; level < kPyramidLevels; ++level) {
    const double sigma = noise.sigma_px * ScaleOfLevel(level);
    const double keypoints = on_level[level] + (level > 0 ? on_level[level - 1] : 0);
    const double in_window = area * sigma * sigma * keypoints / (1.0 * width * height);
    SetChance(level, in_window);
  }
}

PoseEvidence::PoseEvidence(int width, int height, double window,
                           const PoseEvidenceSettings& settings)
    : settings_(settings), width_(width), height_(height), window2_(window * window) {
  for (int level = 0; level < kPyramidLevels; ++level) SetChance(level, 1);
}

void PoseEvidence::SetChance(int level, double in_window) {
  for (size_t q = 0; q < kSimilar.size(); ++q) {
    const double similar = std::max(kSimilar[q] * in_window, 1e-6);
    log_found_[level][q] = std::log(-std::expm1(-similar));
    log_missed_[level][q] = -similar;
  }
}

size_t PoseEvidence::CellAt(double u, double v) const {
  const int column = std::clamp(static_cast<int>(u / width_ * kColumns), 0, kColumns - 1);
  const int row = std::clamp(static_cast<int>(v / height_ * kRows), 0, kRows - 1);
  return static_cast<size_t>(row * kColumns + column);
}

size_t PoseEvidence::PartOf(size_t cell) {
  return cell / kColumns / kPerPart * (kColumns / kPerPart) + cell % kColumns / kPerPart;
}

void PoseEvidence::Missed(double u, double v, int level) {
  Sums& cell = cells_[CellAt(u, v)];
  ++cell.landmarks;
  for (size_t q = 0; q < kSimilar.size(); ++q) cell.chance[q] += log_missed_[level][q];
}

void PoseEvidence::Found(double u, double v, int level, double chi2, double chi2_disparity) {
  Sums& cell = cells_[CellAt(u, v)];
  ++cell.landmarks;
  ++cell.found;
  cell.chi2 += std::min(chi2, window2_);
  if (disparity_spread2_ > 0 && chi2_disparity >= 0) {
    ++cell.disparities;
    cell.chi2_disparity += chi2_disparity;
  }
  for (size_t q = 0; q < kSimilar.size(); ++q) cell.chance[q] += log_found_[level][q];
}

double PoseEvidence::LogLikelihoodRatio() const {
  std::array<Sums, kParts> parts;
  for (size_t i = 0; i < cells_.size(); ++i) {
    const Sums& cell = cells_[i];
    if (cell.landmarks == 0) continue;
    Sums& part = parts[PartOf(i)];
    const double share = 1 / cell.landmarks;
    ++part.landmarks;
    part.found += share * cell.found;
    part.chi2 += share * cell.chi2;
    part.disparities += share * cell.disparities;
    part.chi2_disparity += share * cell.chi2_disparity;
    for (size_t q = 0; q < kSimilar.size(); ++q) part.chance[q] += share * cell.chance[q];
  }
  for (Sums& part : parts) {  // its surface is at one distance, which counts once
    if (part.disparities <= 1) continue;
    part.chi2_disparity /= part.disparities;
    part.disparities = 1;
  }

  // Wrong: the texture (q) that explains the frame best.
  const double spread2 = disparity_spread2_ + 1;
  const double wrong_norm = LogNorm(kFitted, window2_);
  std::array<double, kParts> wrong{};
  double best = -std::numeric_limits<double>::infinity();
  for (size_t q = 0; q < kSimilar.size(); ++q) {
    std::array<double, kParts> chance{};
    double sum = 0;
    for (int i = 0; i < kParts; ++i) {
      const Sums& part = parts[i];
      chance[i] = part.chance[q] - wrong_norm * part.found - 0.5 * part.chi2 / (kFitted * kFitted) -
                  0.5 * (std::log(spread2) * part.disparities + part.chi2_disparity / spread2);
      sum += chance[i];
    }
    if (sum <= best) continue;
    best = sum;
    wrong = chance;
  }

  // Right: the mean over the noise s and the share p.
  const double log_clear = std::log1p(-settings_.occluded),
               log_hidden = std::log(settings_.occluded);
  const double log_other = std::log1p(-settings_.look_alike),
               log_like = std::log(settings_.look_alike);
  double ratio = -std::numeric_limits<double>::infinity();
  for (const auto& [s, share] : kNoises) {
    const double s2 = s * s;
    const double log_norm = LogNorm(s, window2_);
    for (const double p : kFound) {
      double sum = std::log(share / static_cast<double>(kFound.size()));
      for (int i = 0; i < kParts; ++i) {
        const Sums& part = parts[i];
        if (part.landmarks == 0) continue;
        const double x = part.found * (std::log(p) - log_norm) - 0.5 * part.chi2 / s2 +
                         (part.landmarks - part.found) * std::log1p(-p) -
                         part.disparities * std::log(s) - 0.5 * part.chi2_disparity / s2 - wrong[i];
        sum += LogSum(log_clear + x, log_hidden) - LogSum(log_other, log_like + x);
      }
      ratio = LogSum(ratio, sum);
    }
  }
  return ratio;
}

}  // namespace alidade
