#include "alidade/geometry/two_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"
#include "alidade/geometry/fundamental.h"
#include "alidade/geometry/homography.h"
#include "alidade/geometry/motion_ranking.h"
#include "alidade/geometry/relative_pose.h"
#include "alidade/geometry/turned_lens.h"
#include "alidade/geometry/two_view_ransac.h"

namespace alidade {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;
const Eigen::Vector3d kNowhere =
    Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

// The 50th largest value, or the smallest if there are fewer.
double FiftiethLargest(std::vector<double> values) {
  if (values.empty()) return 0;
  const size_t rank = std::min<size_t>(50, values.size()) - 1;
  std::nth_element(values.begin(), values.begin() + rank, values.end(), std::greater<>());
  return values[rank];
}

void Place(const Camera& camera, std::span<const Eigen::Vector2d> a,
           std::span<const Eigen::Vector2d> b, double sigma, TwoViewResult& result) {
  const Se3 identity;
  const double max_squared = kChi2Homography * sigma * sigma;
  const Eigen::Vector3d centre_b = result.T_b_a.Inverse().t;
  const double sine_far = 3 * std::sqrt(2.0) * sigma / std::min(camera.fx, camera.fy);
  std::vector<double> parallax;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!a[i].allFinite() || !b[i].allFinite()) continue;
    const std::optional<Eigen::Vector3d> p =
        Triangulate(camera, identity, a[i], result.T_b_a, b[i]);
    if (!p) continue;
    if (!((camera.Project(*p) - a[i]).squaredNorm() < max_squared)) continue;
    if (!((camera.Project(result.T_b_a * *p) - b[i]).squaredNorm() < max_squared)) continue;
    const Eigen::Vector3d from_b = *p - centre_b;
    const double angle = std::atan2(p->cross(from_b).norm(), p->dot(from_b));
    if (angle < sine_far) continue;
    parallax.push_back(angle);
    result.inlier[i] = true;
    result.p_a[i] = *p;
  }
  result.parallax_degrees = FiftiethLargest(std::move(parallax)) / kOneDegree;
}

// True if nearly all matches selected by `explained` are also explained by a pure rotation
// (`turned`).
template <typename Explained>
bool OnlyTurned(const std::vector<bool>& turned, Explained explained, double min_beyond) {
  int all = 0, beyond = 0;
  for (size_t i = 0; i < turned.size(); ++i) {
    if (!explained(i)) continue;
    ++all;
    beyond += !turned[i];
  }
  return beyond < min_beyond * all;
}

// The same rays with a noise of `sigma` pixels.
RayPairs WithSigma(RayPairs rays, const Eigen::Vector2d& focal, double sigma) {
  rays.sigma = focal.cwiseInverse() * sigma;
  return rays;
}

// Decides whether the best motion is acceptable, and triangulates its points into `result`.
TwoViewFailure Judge(const Camera& camera, std::span<const Eigen::Vector2d> a,
                     std::span<const Eigen::Vector2d> b, const TwoViewSettings& settings,
                     const RayPairs& rays, const std::vector<RankedMotion>& ranked,
                     TwoViewResult& result) {
  const RankedMotion& best = ranked.front();
  if (best.score.consistent < settings.min_inlier_share * static_cast<double>(rays.size())) {
    return TwoViewFailure::kNoModel;
  }
  result.T_b_a = best.T_b_a;
  result.inlier.assign(a.size(), false);
  result.p_a.assign(a.size(), kNowhere);
  Place(camera, a, b, settings.sigma, result);
  const Eigen::Vector2d focal(camera.fx, camera.fy);
  const auto explained = [&](size_t i) { return best.score.gain[i] > 0; };
  const auto placed = std::count(result.inlier.begin(), result.inlier.end(), true);
  const RayPairs noisy =
      WithSigma(rays, focal, std::max(settings.turn_sigma, best.noise * settings.sigma));
  if (OnlyTurned(ExplainedByRotation(best.T_b_a.R, noisy), explained, settings.min_beyond_turn) ||
      result.parallax_degrees < settings.min_parallax_degrees ||
      static_cast<double>(placed) < settings.min_placed_share * best.score.good ||
      best.direction_sigma > settings.max_direction_sigma_degrees * kOneDegree) {
    return TwoViewFailure::kLowParallax;
  }
  if (settings.lens_uncertainty > 0) {
    RayPairs good = noisy;
    good.a.clear();
    good.b.clear();
    for (size_t i = 0; i < noisy.size(); ++i) {
      if (!explained(i)) continue;
      good.a.push_back(noisy.a[i]);
      good.b.push_back(noisy.b[i]);
    }
    const std::vector<bool> turned =
        ExplainedByTurnedLens(best.T_b_a.R, good, settings.lens_uncertainty);
    if (OnlyTurned(
            turned, [](size_t) { return true; }, settings.min_beyond_lens))
      return TwoViewFailure::kUnknownLens;
  }
  for (size_t i = 1; i < ranked.size(); ++i) {
    if (IsRival(best, ranked[i], settings.max_rival_share)) {
      return TwoViewFailure::kAmbiguous;
    }
  }
  if (placed < settings.min_triangulated ||
      best.score.good < settings.min_good_share * best.score.consistent) {
    return TwoViewFailure::kTooFewPoints;
  }
  return TwoViewFailure::kNone;
}

TwoViewResult Refuse(TwoViewResult result, TwoViewFailure why) {
  result.failure = why;
  result.T_b_a = Se3();
  result.inlier.assign(result.inlier.size(), false);
  result.p_a.assign(result.p_a.size(), kNowhere);
  return result;
}

}  // namespace

std::span<const Setting> TwoViewSettings::Table() {
  using T = TwoViewSettings;
  constexpr SettingRange kBetweenZeroAndOne{.min = 0, .max = 1, .open_min = true, .open_max = true};
  static constexpr Setting kRows[] = {
      PublicSetting<&T::min_parallax_degrees>(
          "start.min_parallax_degrees", kNotNegative, "degrees",
          "One camera: parallax that a map needs to start; less starts sooner, with a poorer map."),
      ExpertSetting<&T::iterations>("start.iterations", FromTo(1, 100000), "",
                                    "RANSAC samples of 8 matches for each two-view model."),
      ExpertSetting<&T::sigma>("start.sigma", kPositive, "px",
                               "Standard deviation of a keypoint in two views."),
      ExpertSetting<&T::homography_share>(
          "start.homography_share", kBetweenZeroAndOne, "",
          "Score share S_H / (S_H + S_F) above which the scene counts as planar."),
      ExpertSetting<&T::max_direction_sigma_degrees>(
          "start.max_direction_sigma_degrees", kPositive, "degrees",
          "Largest standard deviation of the direction of motion."),
      ExpertSetting<&T::min_beyond_turn>(
          "start.min_beyond_turn", kZeroToOne, "",
          "Share of the explained matches that pure rotation must not explain."),
      ExpertSetting<&T::lens_uncertainty>(
          "start.lens_uncertainty", FromTo(0, 2), "",
          "Relative uncertainty of the focal length; 0: the camera is calibrated."),
      ExpertSetting<&T::min_triangulated>("start.min_triangulated", kPositive, "landmarks",
                                          "Landmarks that two views must give."),
      ExpertSetting<&T::min_placed_share>(
          "start.min_placed_share", kZeroToOne, "",
          "Share of the explained matches whose parallax exceeds the noise."),
  };
  return kRows;
}

void TwoViewSettings::Check() const { CheckRanges(*this); }

TwoViewResult ReconstructTwoViews(const Camera& camera, std::span<const Eigen::Vector2d> a,
                                  std::span<const Eigen::Vector2d> b,
                                  const TwoViewSettings& settings) {
  settings.Check();
  if (a.size() != b.size())
    ThrowUsage("two views: as many points are needed in one as in the other");
  TwoViewResult result;
  result.inlier.assign(a.size(), false);
  result.p_a.assign(a.size(), kNowhere);

  // Models use pixels from the principal point in units of sigma; motions use rays.
  const Eigen::Vector2d centre(camera.cx, camera.cy), focal(camera.fx, camera.fy);
  std::vector<Eigen::Vector2d> centred_a, centred_b;
  RayPairs rays;
  rays.sigma = focal.cwiseInverse() * settings.sigma;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!a[i].allFinite() || !b[i].allFinite()) continue;
    centred_a.push_back((a[i] - centre) / settings.sigma);
    centred_b.push_back((b[i] - centre) / settings.sigma);
    rays.a.push_back(centred_a.back().cwiseProduct(rays.sigma).homogeneous());
    rays.b.push_back(centred_b.back().cwiseProduct(rays.sigma).homogeneous());
  }
  if (static_cast<int>(centred_a.size()) < std::max(8, settings.min_triangulated)) {
    return Refuse(std::move(result), TwoViewFailure::kTooFewMatches);
  }

  const RansacModels models =
      FitTwoViewModels(centred_a, centred_b, settings.iterations, settings.seed, settings.parallel);
  const double total = models.homography.score + models.fundamental.score;
  if (!(total > 0)) return Refuse(std::move(result), TwoViewFailure::kNoModel);
  result.homography_share = models.homography.score / total;
  result.planar = result.homography_share > settings.homography_share;

  const Eigen::Matrix3d K =
      Eigen::Vector3d(focal.x() / settings.sigma, focal.y() / settings.sigma, 1).asDiagonal();
  const Eigen::Matrix3d K_inverse = K.diagonal().cwiseInverse().asDiagonal();
  const Eigen::Matrix3d H = K_inverse * models.homography.matrix * K;
  const RansacModel& larger = models.homography.inliers > models.fundamental.inliers
                                  ? models.homography
                                  : models.fundamental;
  // Pure rotation is the most frequent case before initialization, so it is tested first.
  const Eigen::Matrix3d turn = NearestRotation(H.determinant() < 0 ? -H : H);
  if (OnlyTurned(
          ExplainedByRotation(turn, WithSigma(rays, focal, settings.turn_sigma)),
          [&](size_t i) { return larger.inlier[i]; }, settings.min_beyond_turn)) {
    return Refuse(std::move(result), TwoViewFailure::kLowParallax);
  }
  std::vector<Se3> motions = MotionsFromHomography(H);
  const std::vector<Se3> more = MotionsFromEssential(K * models.fundamental.matrix * K);
  motions.insert(motions.end(), more.begin(), more.end());
  std::vector<RankedMotion> ranked = RankMotions(motions, rays);
  if (ranked.empty()) return Refuse(std::move(result), TwoViewFailure::kNoModel);

  // An accepted motion must also win against starts from other directions. This expensive test
  // comes last, because most pairs fail before it.
  TwoViewFailure failure = Judge(camera, a, b, settings, rays, ranked, result);
  if (failure == TwoViewFailure::kNone) {
    ranked = AddOtherDirections(std::move(ranked), rays, settings.min_placed_share);
    failure = Judge(camera, a, b, settings, rays, ranked, result);
  }
  if (failure != TwoViewFailure::kNone) return Refuse(std::move(result), failure);
  result.failure = TwoViewFailure::kNone;
  return result;
}

}  // namespace alidade
