#include "alidade/mapping/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/base/parallel.h"
#include "alidade/features/matching.h"
#include "alidade/geometry/two_view.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

constexpr double kChiSquared1 = 3.84;  // 95 % with 1 degree of freedom
constexpr double kChiSquared2 = 5.991;

struct Partner {
  int a = -1, b = -1;  // keypoint indices
  int distance = 0;
};

// Fundamental matrix: x_b' F x_a = 0 (Hartley & Zisserman 9.1).
Eigen::Matrix3d FundamentalOf(const Camera& camera, const Se3& T_b_a) {
  Eigen::Matrix3d K_inverse;
  K_inverse << 1 / camera.fx, 0, -camera.cx / camera.fx, 0, 1 / camera.fy, -camera.cy / camera.fy,
      0, 0, 1;
  return K_inverse.transpose() * Skew(T_b_a.t) * T_b_a.R * K_inverse;
}

std::vector<int> WithoutLandmark(const KeyFrame& keyframe) {
  std::vector<int> free;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) free.push_back(static_cast<int>(i));
  }
  return free;
}

// Finds the keypoints near a line, several at once.
class KeypointsNearLines {
 public:
  explicit KeypointsNearLines(size_t count) : groups_((count + kLanes - 1) / kLanes) {}
  // `reach`: squared distance, pixels². A keypoint that is not set is near no line.
  void Set(size_t i, const Keypoint& keypoint, float reach) {
    Group& group = groups_[i / kLanes];
    group.x[i % kLanes] = keypoint.x;
    group.y[i % kLanes] = keypoint.y;
    group.reach[i % kLanes] = reach;
  }
  // Calls visit(i) for those near the line a x + b y + c = 0, a² + b² = 1, ascending.
  template <typename Visit>
  void VisitNear(float a, float b, float c, Visit&& visit) const {
    for (size_t n = 0; n < groups_.size(); ++n) {
      const Group& group = groups_[n];
      const Lanes off = a * group.x + b * group.y + c;
      const auto near = off * off <= group.reach;
      typedef long long Halves __attribute__((vector_size(16)));
      const Halves any = reinterpret_cast<Halves>(near);
      if ((any[0] | any[1]) == 0) continue;
      for (int i = 0; i < kLanes; ++i) {
        if (near[i]) visit(static_cast<int>(n) * kLanes + i);
      }
    }
  }

 private:
  static constexpr int kLanes = 4;
  typedef float Lanes __attribute__((vector_size(4 * kLanes)));
  struct Group {
    Lanes x{}, y{}, reach = Lanes{} - 1;
  };
  std::vector<Group> groups_;
};

// Matches by descriptor along epipolar lines, with a ratio test.
std::vector<Partner> MatchAlongLines(const KeyFrame& a, const std::vector<int>& free_a,
                                     const KeyFrame& b, const std::vector<int>& free_b,
                                     const Camera& camera, const MapperSettings& settings) {
  const Se3 T_b_a = b.T_camera_world * a.T_camera_world.Inverse();
  const Eigen::Matrix3d F = FundamentalOf(camera, T_b_a);
  const bool epipole_seen = T_b_a.t.z() > 1e-6;
  const Eigen::Vector2d epipole =
      epipole_seen ? camera.Project(T_b_a.t) : Eigen::Vector2d(-1e9, -1e9);

  KeypointsNearLines candidates(free_b.size());
  for (size_t j = 0; j < free_b.size(); ++j) {
    const Keypoint& keypoint = b.frame->keypoints[free_b[j]];
    const double sigma = settings.noise.sigma_px * ScaleOfLevel(keypoint.level);
    // Close to the epipole all directions are consistent and the depth is undetermined.
    if ((keypoint.pixel() - epipole).squaredNorm() >= 100 * ScaleOfLevel(keypoint.level))
      candidates.Set(j, keypoint, static_cast<float>(kChiSquared1 * sigma * sigma));
  }
  std::vector<Partner> best_for_b(free_b.size());
  for (int i : free_a) {
    const Keypoint& keypoint = a.frame->keypoints[i];
    const Eigen::Vector3d line = F * Eigen::Vector3d(keypoint.x, keypoint.y, 1);
    const double norm = std::hypot(line.x(), line.y());
    if (!(norm > 0)) continue;
    const auto lx = static_cast<float>(line.x() / norm), ly = static_cast<float>(line.y() / norm),
               lc = static_cast<float>(line.z() / norm);
    int best = 256, second = 256, best_j = -1;
    candidates.VisitNear(lx, ly, lc, [&](int j) {
      const int distance =
          HammingDistance(a.frame->descriptors[i], b.frame->descriptors[free_b[j]]);
      if (distance < best) {
        second = best;
        best = distance;
        best_j = j;
      } else if (distance < second) {
        second = distance;
      }
    });
    if (best > settings.triangulate_distance || best > settings.triangulate_ratio * second)
      continue;
    Partner& held = best_for_b[best_j];
    if (held.a < 0 || best < held.distance) held = {i, free_b[best_j], best};
  }
  std::vector<Partner> partners;
  std::vector<float> turns;
  for (const Partner& partner : best_for_b) {
    if (partner.a < 0) continue;
    partners.push_back(partner);
    turns.push_back(a.frame->keypoints[partner.a].angle - b.frame->keypoints[partner.b].angle);
  }
  const std::vector<bool> keep = ConsistentTurns(turns);
  std::vector<Partner> kept;
  for (size_t i = 0; i < partners.size(); ++i) {
    if (keep[i]) kept.push_back(partners[i]);
  }
  std::sort(kept.begin(), kept.end(), [](const Partner& p, const Partner& q) { return p.a < q.a; });
  return kept;
}

}  // namespace

bool FitsKeypoint(const Camera& camera, const KeyFrame& keyframe, const Keypoint& keypoint,
                  const Eigen::Vector3d& p_world, const MapperSettings& settings) {
  const Eigen::Vector3d p = keyframe.T_camera_world * p_world;
  if (p.z() <= 0) return false;
  const double sigma = settings.noise.sigma_px * ScaleOfLevel(keypoint.level);
  return (camera.Project(p) - keypoint.pixel()).squaredNorm() <= kChiSquared2 * sigma * sigma;
}

std::vector<NewLandmark> TriangulateNew(const MapSnapshot& map, KeyFrameId id,
                                        const std::vector<KeyFrameId>& at_known_distance,
                                        const Camera& camera, const MapperSettings& settings) {
  const KeyFrame& a = *map.Find(id);
  const bool has_depth = camera.StereoBaseline() > 0;
  const auto count = static_cast<size_t>(has_depth ? settings.triangulate_keyframes_depth
                                                   : settings.triangulate_keyframes_mono);
  const double median_depth = MedianDepth(map, a).value_or(1);
  const Eigen::Vector3d centre_a = a.Centre();
  const std::vector<int> free_a = WithoutLandmark(a);

  std::vector<const KeyFrame*> others;
  for (size_t i = 0; i < a.covisible.size() && others.size() < count; ++i) {
    const KeyFrame* b = map.Find(a.covisible[i].id);
    if (!b) continue;
    const double baseline = (b->Centre() - centre_a).norm();
    if (baseline <
        (has_depth ? camera.StereoBaseline() : settings.min_baseline_ratio * median_depth))
      continue;
    others.push_back(b);
  }
  const auto known = [&](const KeyFrame* b) {
    return has_depth || std::find(at_known_distance.begin(), at_known_distance.end(), b->id) !=
                            at_known_distance.end();
  };
  // Keyframes at known distance first, each group by descending covisibility.
  std::vector<const KeyFrame*> unknown;
  std::erase_if(others, [&](const KeyFrame* b) {
    if (known(b)) return false;
    unknown.push_back(b);
    return true;
  });
  if (!unknown.empty() && CountOfKnownScale(map, a) < settings.sufficient_known_scale)
    others.insert(others.end(), unknown.begin(), unknown.end());
  std::vector<std::vector<Partner>> partners(others.size());
  ParallelFor(static_cast<int>(others.size()), [&](int i) {
    partners[i] =
        MatchAlongLines(a, free_a, *others[i], WithoutLandmark(*others[i]), camera, settings);
  });

  const double min_degrees =
      has_depth ? settings.min_parallax_degrees : settings.min_parallax_degrees_mono;
  const double max_cosine = std::cos(min_degrees * std::numbers::pi / 180);
  std::vector<NewLandmark> made;
  std::vector<uint8_t> used(a.landmarks.size(), 0);
  for (size_t n = 0; n < others.size(); ++n) {
    const KeyFrame& b = *others[n];
    const Eigen::Vector3d centre_b = b.Centre();
    for (const Partner& partner : partners[n]) {
      if (used[partner.a]) continue;
      const Keypoint &key_a = a.frame->keypoints[partner.a], &key_b = b.frame->keypoints[partner.b];
      const auto p =
          Triangulate(camera, a.T_camera_world, key_a.pixel(), b.T_camera_world, key_b.pixel());
      if (!p || !FitsKeypoint(camera, a, key_a, *p, settings) ||
          !FitsKeypoint(camera, b, key_b, *p, settings))
        continue;
      const Eigen::Vector3d ray_a = *p - centre_a, ray_b = *p - centre_b;
      const double distance_a = ray_a.norm(), distance_b = ray_b.norm();
      if (ray_a.dot(ray_b) > max_cosine * distance_a * distance_b) continue;
      // The ratio of the scales must agree with the ratio of the distances.
      const double change =
          distance_b / distance_a * ScaleOfLevel(key_b.level) / ScaleOfLevel(key_a.level);
      constexpr double kTolerance = 1.5 * kPyramidScale;
      if (change > kTolerance || change < 1 / kTolerance) continue;
      used[partner.a] = 1;
      made.push_back({*p, {b.id, partner.b}, {a.id, partner.a}, known(&b)});
    }
  }
  return made;
}

}  // namespace alidade
