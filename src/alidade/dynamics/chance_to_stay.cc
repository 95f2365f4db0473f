#include "alidade/dynamics/chance_to_stay.h"

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/features/matching.h"
#include "alidade/geometry/relative_pose.h"
#include "alidade/geometry/two_view.h"

namespace alidade {
namespace {

constexpr float kMatchWindow = 0.16f;   // of the image width: largest displacement of a match
constexpr size_t kFewest = 30;          // matches that determine a motion
constexpr double kAgreeing = 0.5;       // share of the matches that must agree on it
constexpr double kFar = 2.5;            // of `tolerance`: median displacement, at least
constexpr double kSigma = 1.0;          // pixels, of a keypoint
constexpr size_t kNearPerInfinite = 5;  // points with a depth per point at infinity

struct MovedMatches {
  std::vector<Eigen::Vector2d> a, b;  // undistorted pixels
  RayPairs rays;
  double median = 0;  // displacement, pixels
};

MovedMatches MatchesThatMoved(const Camera& camera, const Frame& then, const Frame& now,
                              double tolerance) {
  std::vector<Eigen::Vector2f> guess;
  guess.reserve(then.keypoints.size());
  for (const Keypoint& k : then.keypoints) guess.push_back({k.x, k.y});
  MovedMatches moved;
  std::vector<double> displacements;
  moved.rays.sigma = {kSigma / camera.fx, kSigma / camera.fy};
  const float window = kMatchWindow * static_cast<float>(camera.width);
  for (const IndexMatch& match : MatchWindow(then, now, guess, window)) {
    const Eigen::Vector2d a = then.keypoints[match.a].pixel(), b = now.keypoints[match.b].pixel();
    if ((a - b).norm() < tolerance) continue;
    displacements.push_back((a - b).norm());
    moved.a.push_back(a);
    moved.b.push_back(b);
    moved.rays.a.push_back(camera.Unproject(a));
    moved.rays.b.push_back(camera.Unproject(b));
  }
  if (!displacements.empty()) moved.median = UpperMedian(displacements);
  return moved;
}

// The rotation that turns the rays into each other best, all depths taken as infinite (Kabsch).
Eigen::Matrix3d TurnOf(const RayPairs& rays) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < rays.size(); ++i)
    sum += rays.b[i].normalized() * rays.a[i].normalized().transpose();
  return NearestRotation(sum);
}

// The best of the motions refined from the 26 directions of a cube's corners, edges and faces.
std::optional<Se3> MotionOf(const RayPairs& rays) {
  const Eigen::Matrix3d R = TurnOf(rays);
  std::optional<Se3> best;
  double best_score = 0;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3d direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (direction.isZero()) continue;
    Se3 start;
    start.R = R;
    start.t = direction.normalized();
    const Se3 motion = RefineMotion(start, rays, 100).T_b_a;
    const MotionScore score = ScoreMotion(motion, rays);
    if (score.score <= best_score || score.good < kAgreeing * static_cast<double>(rays.size()))
      continue;
    best_score = score.score;
    best = motion;
  }
  return best;
}

}  // namespace

cv::Mat ChanceToStay(const Camera& camera, const Frame& then, const Frame& now, int cell,
                     double tolerance) {
  const MovedMatches moved = MatchesThatMoved(camera, then, now, tolerance);
  if (moved.a.size() < kFewest || moved.median < kFar * tolerance) return {};
  const std::optional<Se3> T_now_then = MotionOf(moved.rays);
  if (!T_now_then) return {};
  std::vector<double> inverse_depths;  // in the first frame, 1 / length of the motion
  for (size_t i = 0; i < moved.a.size(); ++i) {
    const auto p = Triangulate(camera, Se3(), moved.a[i], *T_now_then, moved.b[i]);
    if (p) inverse_depths.push_back(1 / p->z());
  }
  inverse_depths.resize(inverse_depths.size() + inverse_depths.size() / kNearPerInfinite + 1, 0.0);

  cv::Mat chance(camera.height / cell + 1, camera.width / cell + 1, CV_32F);
  for (int y = 0; y < chance.rows; ++y) {
    for (int x = 0; x < chance.cols; ++x) {
      const Eigen::Vector2d pixel = camera.Undistort({(x + 0.5) * cell, (y + 0.5) * cell});
      const Eigen::Vector3d turned = T_now_then->R * camera.Unproject(pixel);
      int stays = 0;
      for (const double inverse_depth : inverse_depths) {
        const Eigen::Vector3d p = turned + inverse_depth * T_now_then->t;
        stays += p.z() > 0 && (camera.Project(p) - pixel).norm() < tolerance;
      }
      chance.at<float>(y, x) =
          static_cast<float>(stays) / static_cast<float>(inverse_depths.size());
    }
  }
  return chance;
}

}  // namespace alidade
