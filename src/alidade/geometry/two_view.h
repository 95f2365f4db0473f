// Relative pose and points from two views of an unknown scene, or the reason why they cannot be
// determined. Homography and fundamental matrix in parallel, model selection and motion hypotheses:
// Mur-Artal, Montiel & Tardós 2015, §IV. Eight-point algorithm and decomposition: Hartley &
// Zisserman, ch. 9 and 11; Faugeras & Lustman 1988.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in two_view.cc.
struct TwoViewSettings {
  int iterations = 200;
  double sigma = 1.0;
  double homography_share = 0.45;
  // With 1.0 instead of 1.5, half of the starts come 5 to 15 frames sooner with errors as small.
  double min_parallax_degrees = 1.0;
  // In images 400 pixels wide it is 4 to 6 when a map can well be made; bundle adjustment soon
  // improves it.
  double max_direction_sigma_degrees = 8;
  // Pixels, standard deviation of a keypoint in the test for pure rotation (the observed one where
  // that is larger). Corners are placed to 0.3 to 0.5 pixels.
  double turn_sigma = 0.5;
  // In simulated scenes, noise leaves up to 0.08 in pure rotation; moving cameras have at least
  // 0.4.
  double min_beyond_turn = 0.2;
  // 0 when the camera is calibrated. Otherwise no map starts from matches that a rotation with
  // another focal length explains (ExplainedByTurnedLens).
  double lens_uncertainty = 0;
  // As min_beyond_turn, for a rotation with another focal length.
  double min_beyond_lens = 0.3;
  int min_triangulated = 50;
  // Share of the inliers that must triangulate in front of both cameras with a small error.
  double min_good_share = 0.9;
  // Motions fitted to noise (mostly straight ahead) place few matches and leave the rest far away.
  double min_placed_share = 0.35;
  // The second-best motion may explain at most this share of the best one's points.
  double max_rival_share = 0.75;
  // Share of the matches that the motion must explain. Among more outliers, chance finds motions
  // that explain as many as the true one.
  double min_inlier_share = 0.45;
  uint64_t seed = 1;
  // Samples on all threads; the result is the same without.
  bool parallel = true;
  static std::span<const Setting> Table();
  void Check() const;
};

enum class TwoViewFailure {
  kNone,
  kTooFewMatches,
  kNoModel,
  kLowParallax,
  // Pure rotation with another focal length or radial distortion explains the matches.
  kUnknownLens,
  kAmbiguous,
  kTooFewPoints
};

struct TwoViewResult {
  TwoViewFailure failure = TwoViewFailure::kTooFewMatches;  // kNone: all fields are valid
  bool planar = false;                                      // homography_share exceeds the setting
  double homography_share = 0;                              // S_H / (S_H + S_F)
  double parallax_degrees = 0;  // as for min_parallax_degrees of the settings
  Se3 T_b_a;                    // motion from the first to the second view, |t| = 1
  std::vector<bool> inlier;     // one per match: triangulated with small error
  // One per match: the point in the frame of the first view, unit |t|; NaN if not an inlier.
  std::vector<Eigen::Vector3d> p_a;
};

// `a` and `b` are corresponding undistorted pixels of one camera; non-finite matches are never
// inliers. Near the model-selection threshold neither model is reliable, so the motions of both are
// candidates. Each is refined on all matches, and the result is accepted only if no other motion
// comes near it. Throws Error (usage) if the sizes differ.
TwoViewResult ReconstructTwoViews(const Camera& camera, std::span<const Eigen::Vector2d> a,
                                  std::span<const Eigen::Vector2d> b,
                                  const TwoViewSettings& settings = {});

// Linear triangulation of a point from undistorted pixels in two cameras (Hartley & Zisserman
// 12.2). Returns the point in the world frame, or nullopt if it is not finite or behind a camera.
std::optional<Eigen::Vector3d> Triangulate(const Camera& camera, const Se3& T_a_world,
                                           const Eigen::Vector2d& pixel_a, const Se3& T_b_world,
                                           const Eigen::Vector2d& pixel_b);

}  // namespace alidade
