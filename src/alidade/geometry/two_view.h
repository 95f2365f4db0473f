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

struct TwoViewSettings {
  int iterations = 200;            // RANSAC samples of 8 matches, for each model
  double sigma = 1.0;              // standard deviation of a keypoint, pixels
  double homography_share = 0.45;  // S_H / (S_H + S_F) above which the scene counts as planar
  // Of the triangulated points (the 50th largest, or the last). 1 instead of 1.5: half of the
  // starts of hand-held and driven cameras come 5 to 15 frames sooner, with errors as small.
  double min_parallax_degrees = 1.0;
  // Of the direction of motion, as left by the noise. In pictures 400 pixels wide it is 4 to 6 when
  // a map can well be made; bundle adjustment soon makes it better.
  double max_direction_sigma_degrees = 8;
  // Standard deviation of a keypoint, pixels, when it is asked whether a camera that only turned
  // explains the matches (what is found in them counts where it is more). Corners are placed to 0.3
  // to 0.5 pixels.
  double turn_sigma = 0.5;
  // Of the matches a motion explains, so many must be beyond what a camera that only turned
  // explains. On made-up scenes a turning one leaves up to 0.08 for noise, moving ones 0.4 and
  // more.
  double min_beyond_turn = 0.2;
  // Relative uncertainty of the focal length: 0 when the camera is calibrated. Else no map is begun
  // from matches that a turn with another lens explains (ExplainedByTurnedLens).
  double lens_uncertainty = 0;
  double min_beyond_lens = 0.3;  // as min_beyond_turn, of a turn with another lens
  int min_triangulated = 50;     // points
  double min_good_share =
      0.9;  // of the inliers that must triangulate in front of both, with small error
  // Of what the motion explains, so much must be placed: have parallax beyond the noise. Motions
  // made up from the noise (mostly straight ahead) place a few matches and leave the rest far away.
  double min_placed_share = 0.35;
  double max_rival_share =
      0.75;  // second-best motion hypothesis may explain at most this share of the best's points
  double min_inlier_share =
      0.45;  // of the matches that the motion must explain: among more outliers
             // chance makes up motions that explain as many as the true one
  uint64_t seed = 1;
  bool parallel = true;  // samples over the threads; the result is the same without
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
