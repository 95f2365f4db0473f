// Settings of semi-dense mapping; names as in Mur-Artal & Tardós, RSS 2015 ("the paper").
#pragma once

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct SemiDenseSettings {
  bool enabled = false;
  bool from_sensor = false;  // for comparison: depth from the sensor instead of from motion (RGB-D)

  int keyframes = 7;        // N: best covisible keyframes searched for each pixel
  double min_gradient = 8;  // λ_G: grey levels per pixel; noise of 4 passes in 0.01 % of pixels
  double max_edge_angle =
      80;  // λ_L: degrees between gradient and epipolar line; beyond, the edge runs along the line
  double max_turn = 45;  // λ_θ: degrees of difference between gradient directions of a match
  double gradient_weight =
      0.23;  // θ: variance of gradient magnitudes as a share of that of intensities
  // σ_I: grey levels. The paper has 20 for a single pixel; here five are compared, and what poses
  // get wrong has a term of its own (line_sigma).
  double intensity_sigma = 8;
  double line_sigma = 0.5;  // of a pixel's epipolar line, by errors of poses: pixels
  double max_residual =
      25;  // grey levels, root mean square, between a pixel's surroundings and their match
  double chi2_pair = 5.99;   // hypotheses fused are this compatible (95 %, 2 degrees of freedom)
  double chi2_check = 3.84;  // those of other keyframes this much (95 %, 1)
  int min_compatible = 3;    // λ_N: hypotheses that agree, keyframes that confirm

  // A keyframe's depth is kept only where landmarks beside it lie that near, as a share of inverse
  // depth, three in four. Good maps: below 0.035; a camera that only turned: 0.07 and more.
  double max_landmark_difference = 0.05;

  bool fuse = true;         // step 2; off: the hypothesis of smallest variance holds
  bool smooth = true;       // step 3: neighbours within the keyframe
  bool cross_check = true;  // step 4: between keyframes

  int delay = 2;  // keyframes that must follow before one is worked on: parallax from both sides
  double redo_baseline =
      0.02;  // a keyframe is worked on again when a baseline changed by this share

  // Keyframes that wait for their depth, at most: on a machine that cannot keep up the oldest are
  // let go and stay without. Each holds its picture, 1.2 MB at 640 × 480 in colour.
  int max_waiting = 200;

  double voxel = 0.005;  // edge of the cubes that hold one point of semidense.ply each; metres or
                         // map units; 0 = all points

  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
