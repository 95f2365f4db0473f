#include "alidade/run/world/position_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "alidade/base/degrees.h"
#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/base/random.h"
#include "alidade/geometry/alignment.h"
#include "alidade/run/world/position_pairs.h"

namespace alidade {
namespace {

constexpr size_t kFewest = 6;     // positions
constexpr double kTrimmed = 0.6;  // share of the positions that a hypothesis must explain
constexpr int kHypotheses = 40;
constexpr size_t kMostTried = 60;      // positions in the search for the offset
constexpr double kNearOffset = 5;      // seconds: clocks that overlap are off by no more
constexpr double kOffsetStep = 0.1;    // seconds
constexpr double kFinest = 0.01;       // seconds, of the search; the fit does the rest
constexpr double kLeastOverlap = 0.5;  // of the shorter of both spans
constexpr double kGate = 3.6;          // standard deviations: 99.5 % of the lengths of 3 errors
constexpr double kLeastError = 0.005;  // meters: a smaller error is not believed
// What is too uncertain to be used.
constexpr double kMostScale = 0.05, kMostRotation = 0.05;  // relative, radians
constexpr double kLeastUsed = 0.5;                         // of the matched positions

std::string Text(const char* format, double a, double b = 0) {
  char text[160];
  PrintTo(text, sizeof(text), format, a, b);
  return text;
}

Eigen::Vector3d ResidualOf(const Sim3& T, const PositionPair& pair,
                           const Eigen::Vector3d& antenna) {
  return T * pair.map + T.R * (pair.R * antenna) - pair.measured;
}

class PositionFitter {
 public:
  PositionFitter(const Trajectory& trajectory, const std::vector<TimedPosition>& positions,
                 const PositionFitSettings& settings)
      : path_(trajectory), trajectory_(trajectory), positions_(positions), settings_(settings) {}

  PositionFit Run() {
    if (trajectory_.size() < 2 || positions_.size() < kFewest) return Refused(TooFew(0));
    if (!FindOffset()) return Refused(TooFew(PairsAt(path_, positions_, 0).size()));
    pairs_ = PairsAt(path_, positions_, offset_);
    if (pairs_.size() < kFewest) return Refused(TooFew(pairs_.size()));
    const auto start = Trimmed(pairs_, /*upright=*/false);
    PositionFit fit = start ? Refined(start->T, /*gravity=*/false) : PositionFit{};
    if (start && fit.why_not.empty()) return fit;
    if (!settings_.down) return start ? fit : Refused("all positions coincide");
    const auto upright = Trimmed(pairs_, /*upright=*/true);
    return upright ? Refined(upright->T, /*gravity=*/true) : fit;
  }

 private:
  struct Hypothesis {
    Sim3 T;
    double cost = 0;  // mean squared residual of the best positions
  };

  static PositionFit Refused(std::string why) {
    PositionFit fit;
    fit.why_not = std::move(why);
    return fit;
  }

  std::string TooFew(size_t matched) const {
    return "too few positions: " + std::to_string(matched) + " of " +
           std::to_string(positions_.size()) + " are at times of the trajectory, and at least " +
           std::to_string(kFewest) + " are needed (are the clocks right? see --time-offset)";
  }

  // The similarity of some pairs; `upright`: known to be upright in both worlds.
  std::optional<Sim3> Align(const PositionPairs& pairs, bool upright) const {
    std::vector<Eigen::Vector3d> from, to;
    Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
    if (upright)
      level = Eigen::Quaterniond::FromTwoVectors(*settings_.down, -Eigen::Vector3d::UnitZ())
                  .toRotationMatrix();
    for (const PositionPair& pair : pairs) {
      from.push_back(level * pair.map);
      to.push_back(pair.measured);
    }
    if (!upright) {
      try {
        return AlignPoints(to, from, !settings_.meters);
      } catch (const Error&) {
        return std::nullopt;
      }
    }
    Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
    for (size_t i = 0; i < from.size(); ++i) {
      a += from[i] / static_cast<double>(from.size());
      b += to[i] / static_cast<double>(to.size());
    }
    double dot = 0, cross = 0, vertical = 0, size = 0;
    for (size_t i = 0; i < from.size(); ++i) {
      const Eigen::Vector3d p = from[i] - a, q = to[i] - b;
      dot += p.x() * q.x() + p.y() * q.y();
      cross += p.x() * q.y() - p.y() * q.x();
      vertical += p.z() * q.z();
      size += p.squaredNorm();
    }
    if (!(size > 0)) return std::nullopt;
    Sim3 T;
    T.R = Eigen::AngleAxisd(std::atan2(cross, dot), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T.s = settings_.meters ? 1 : (std::hypot(dot, cross) + vertical) / size;
    if (!(T.s > 0)) return std::nullopt;
    T.t = b - T.s * (T.R * a);
    T.R = T.R * level;
    return T;
  }

  // Least trimmed squares.
  std::optional<Hypothesis> Trimmed(const PositionPairs& pairs, bool upright) const {
    const int minimal = upright ? 2 : 3;
    const auto kept = std::max<size_t>(
        static_cast<size_t>(minimal),
        static_cast<size_t>(std::ceil(kTrimmed * static_cast<double>(pairs.size()))));
    if (pairs.size() < kFewest) return std::nullopt;
    Random random(1);
    std::optional<Hypothesis> best;
    std::vector<std::pair<double, size_t>> errors(pairs.size());
    for (int h = 0; h < kHypotheses; ++h) {
      PositionPairs chosen;
      for (const int i : random.Sample(minimal, static_cast<int>(pairs.size())))
        chosen.push_back(pairs[static_cast<size_t>(i)]);
      double cost = 0;
      std::optional<Sim3> T = Align(chosen, upright);
      for (int step = 0; T && step < 3; ++step) {
        for (size_t i = 0; i < pairs.size(); ++i)
          errors[i] = {ResidualOf(*T, pairs[i], settings_.antenna).squaredNorm(), i};
        std::nth_element(errors.begin(), errors.begin() + static_cast<long>(kept) - 1,
                         errors.end());
        cost = 0;
        chosen.clear();
        for (size_t k = 0; k < kept; ++k) {
          cost += errors[k].first / static_cast<double>(kept);
          chosen.push_back(pairs[errors[k].second]);
        }
        if (step < 2) T = Align(chosen, upright);
      }
      if (T && (!best || cost < best->cost)) best = Hypothesis{*T, cost};
    }
    return best;
  }

  // Tries offsets of the clocks; false if none has enough positions.
  bool FindOffset() {
    offset_ = settings_.time_offset.value_or(0);
    if (settings_.time_offset) return true;
    const double begin = trajectory_.front().time, end = trajectory_.back().time;
    const double first = positions_.front().time, last = positions_.back().time;
    const double shorter = std::min(end - begin, last - first);
    const double overlap = std::min(end, last) - std::max(begin, first);
    double low = -kNearOffset, high = kNearOffset;
    if (overlap < kLeastOverlap * shorter) {  // other clocks
      low = first - end + kLeastOverlap * shorter;
      high = last - begin - kLeastOverlap * shorter;
    }
    // Not more than some thousand offsets, and a second as the longest step.
    constexpr double kMostSteps = 4000, kCoarsest = 1;
    const double step = std::clamp((high - low) / kMostSteps, kOffsetStep, kCoarsest);
    std::vector<std::pair<double, size_t>> found;  // offset, matched
    size_t most = 0;
    const long steps = std::lround(std::min((high - low) / step, 5 * kMostSteps));
    std::vector<TimedPosition> some;
    // Spread over what may overlap.
    const size_t stride = 1 + positions_.size() / (4 * kMostTried);
    for (size_t i = 0; i < positions_.size(); i += stride) some.push_back(positions_[i]);
    for (long k = 0; k <= steps; ++k) {
      const double offset = low + step * static_cast<double>(k);
      const size_t matched = PairsAt(path_, some, offset).size();
      found.push_back({offset, matched});
      most = std::max(most, matched);
    }
    if (most < std::min(kFewest, some.size())) return false;
    double best = INFINITY;
    const auto attempt = [&](double offset) {
      // Of nearly equal ones the smallest: a path at constant velocity does not tell it.
      const double far = std::abs(offset - (low + high) / 2);
      const double cost = (CostAt(some, offset) + 1e-6) * (1 + 1e-3 * far);
      if (!(cost < best)) return;
      best = cost;
      offset_ = offset;
    };
    for (const auto& [offset, matched] : found) {
      if (2 * matched >= most) attempt(offset);
    }
    for (double finer = step / 2; finer > kFinest; finer /= 2) {
      const double around = offset_;
      attempt(around - finer);
      attempt(around + finer);
    }
    return std::isfinite(best);
  }

  // Of the best hypothesis; infinite: there is none.
  double CostAt(const std::vector<TimedPosition>& some, double offset) const {
    PositionPairs pairs = PairsAt(path_, some, offset);
    if (pairs.size() < kFewest) return INFINITY;
    while (pairs.size() > kMostTried) {
      PositionPairs half;
      for (size_t i = 0; i < pairs.size(); i += 2) half.push_back(pairs[i]);
      pairs = std::move(half);
    }
    const auto hypothesis = Trimmed(pairs, /*upright=*/false);
    return hypothesis ? hypothesis->cost : INFINITY;
  }

  // Gauss–Newton over the positions that agree.
  PositionFit Refined(Sim3 T, bool gravity) {
    PositionFit fit;
    double offset = offset_, sigma = SigmaOf(T);
    Eigen::Matrix<double, 8, 8> information;
    double inflated = 1;
    for (int round = 0; round < 12; ++round) {
      pairs_ = PairsAt(path_, positions_, offset);
      if (pairs_.size() < kFewest) return Refused(TooFew(pairs_.size()));
      information.setZero();
      Eigen::Matrix<double, 8, 1> gradient = Eigen::Matrix<double, 8, 1>::Zero();
      double sum = 0, along = 0;
      int count = 0;
      Eigen::Vector3d before = Eigen::Vector3d::Zero();  // zero: an outlier
      fit.used.assign(pairs_.size(), false);
      for (size_t i = 0; i < pairs_.size(); ++i) {
        const PositionPair& pair = pairs_[i];
        const Eigen::Vector3d r = ResidualOf(T, pair, settings_.antenna);
        if (r.norm() > kGate * sigma) {
          before.setZero();
          continue;
        }
        fit.used[i] = true;
        const Eigen::Vector3d turned = T.s * (T.R * pair.map) + T.R * (pair.R * settings_.antenna);
        Eigen::Matrix<double, 3, 8> J;  // scale (log), rotation (left), translation, offset
        J.col(0) =
            settings_.meters ? Eigen::Vector3d::Zero() : Eigen::Vector3d(T.s * (T.R * pair.map));
        J.middleCols<3>(1) = -Skew(turned);
        J.middleCols<3>(4) = Eigen::Matrix3d::Identity();
        J.col(7) = settings_.time_offset ? Eigen::Vector3d::Zero()
                                         : Eigen::Vector3d(-T.s * (T.R * pair.velocity));
        information += J.transpose() * J / (sigma * sigma);
        gradient += J.transpose() * r / (sigma * sigma);
        sum += r.squaredNorm();
        along += r.dot(before);
        before = r;
        ++count;
      }
      fit.matched = static_cast<int>(pairs_.size());
      if (count < static_cast<int>(kFewest) || count < kLeastUsed * fit.matched) {
        return Refused("the positions contradict the path: only " + std::to_string(count) + " of " +
                       std::to_string(fit.matched) + " agree within " +
                       Text("%.3g m", kGate * sigma));
      }
      sigma = std::max(kLeastError, std::sqrt(sum / (3 * count - 8)));
      // Errors that go on from one position to the next tell less than independent ones.
      const double rho = sum > 0 ? std::clamp(along / sum, 0.0, 0.98) : 0;
      inflated = (1 + rho) / (1 - rho);
      AddPriors(T, gravity, offset, inflated, information, gradient);
      const Eigen::Matrix<double, 8, 1> step = -information.ldlt().solve(gradient);
      if (!step.allFinite()) return Refused("the positions do not determine an alignment");
      T.s *= std::exp(std::clamp(step[0], -0.5, 0.5));
      T.R = ExpSo3(step.segment<3>(1)) * T.R;
      T.t += step.segment<3>(4);
      offset += std::clamp(step[7], -0.5, 0.5);
    }
    Eigen::Matrix<double, 8, 8> covariance =
        information.ldlt().solve(Eigen::Matrix<double, 8, 8>::Identity());
    covariance *= inflated;
    fit.T_positions_world = T;
    fit.time_offset = offset;
    fit.time_offset_sigma = settings_.time_offset ? 0 : std::sqrt(covariance(7, 7));
    fit.scale_sigma = settings_.meters ? 0 : std::sqrt(covariance(0, 0));
    fit.tilt_sigma = std::sqrt(std::max(covariance(1, 1), covariance(2, 2)));
    fit.rotation_sigma = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                       Eigen::Matrix3d(covariance.block<3, 3>(1, 1)))
                                       .eigenvalues()
                                       .maxCoeff());
    fit.by_gravity = gravity;
    for (const PositionPair& pair : pairs_) {
      fit.times.push_back(pair.time);
      fit.positions.push_back(pair.measured);
      fit.residuals.push_back(ResidualOf(T, pair, settings_.antenna).norm());
    }
    fit.why_not = WhyNot(fit);
    return fit;
  }

  // `inflated`: by which all variances will be multiplied.
  void AddPriors(const Sim3& T, bool gravity, double offset, double inflated,
                 Eigen::Matrix<double, 8, 8>& information,
                 Eigen::Matrix<double, 8, 1>& gradient) const {
    constexpr double kOffsetSigma = 30;  // seconds
    if (settings_.meters) information(0, 0) += 1e12;
    information(7, 7) += settings_.time_offset ? 1e12 : inflated / (kOffsetSigma * kOffsetSigma);
    if (!settings_.time_offset)
      gradient[7] += inflated * (offset - offset_) / (kOffsetSigma * kOffsetSigma);
    if (!gravity) return;
    // Small turn about x and y that brings the known vertical to -z.
    const Eigen::Vector3d down = T.R * *settings_.down;
    const double weight = inflated / (settings_.down_sigma * settings_.down_sigma);
    const Eigen::Vector3d error = down.cross(-Eigen::Vector3d::UnitZ());  // turn that is needed
    for (int k = 0; k < 2; ++k) {
      information(1 + k, 1 + k) += weight;
      gradient[1 + k] -= weight * error[k];
    }
  }

  // Of one coordinate, from the best positions.
  double SigmaOf(const Sim3& T) const {
    std::vector<double> errors;
    for (const PositionPair& pair : pairs_)
      errors.push_back(ResidualOf(T, pair, settings_.antenna).norm());
    const auto at =
        errors.begin() + static_cast<long>(kTrimmed * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), at, errors.end());
    constexpr double kRank = 1.716;  // 60 % of the lengths of three errors of 1
    return std::max(kLeastError, *at / kRank);
  }

  static std::string WhyNot(const PositionFit& fit) {
    if (!(fit.scale_sigma < kMostScale)) {
      return "the scale is not observable: the positions tell it to " +
             Text("%.0f %% (at most %.0f %%)", 100 * fit.scale_sigma, 100 * kMostScale) +
             "; they are too few, too close together or too inaccurate for it";
    }
    if (!(fit.rotation_sigma < kMostRotation)) {
      return "the rotation is not observable: the positions tell it to " +
             Text("%.0f degrees (at most %.1f)", std::min(180., kDegrees * fit.rotation_sigma),
                  kDegrees * kMostRotation) +
             "; a straight path does not tell the rotation about itself. Give inertial readings "
             "first, or positions of a path that turns";
    }
    return {};
  }

  PathAt path_;
  const Trajectory& trajectory_;
  const std::vector<TimedPosition>& positions_;
  const PositionFitSettings& settings_;
  double offset_ = 0;
  PositionPairs pairs_;
};

}  // namespace

int PositionFit::used_count() const {
  return static_cast<int>(std::count(used.begin(), used.end(), true));
}

double PositionFit::Quantile(double share) const {
  std::vector<double> kept;
  for (size_t i = 0; i < residuals.size(); ++i) {
    if (used[i]) kept.push_back(residuals[i]);
  }
  if (kept.empty()) return 0;
  std::sort(kept.begin(), kept.end());
  return kept[static_cast<size_t>(std::lround(share * static_cast<double>(kept.size() - 1)))];
}

PositionFit FitPositions(const Trajectory& trajectory, const std::vector<TimedPosition>& positions,
                         const PositionFitSettings& settings) {
  return PositionFitter(trajectory, positions, settings).Run();
}

}  // namespace alidade
