// Settings of semi-dense mapping; names as in Mur-Artal & Tardós, RSS 2015 ("the paper").
#pragma once

#include <span>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in settings.cc.
struct SemiDenseSettings {
  bool enabled = false;
  bool from_sensor = false;

  // N
  int keyframes = 7;
  // λ_G. Noise of 4 grey levels passes in 0.01 % of the pixels.
  double min_gradient = 8;
  // λ_L. Beyond, the edge runs along the epipolar line.
  double max_edge_angle = 80;
  // λ_θ
  double max_turn = 45;
  // θ: ratio of the variance of gradient magnitudes to that of intensities.
  double gradient_weight = 0.23;
  // σ_I. The paper has 20 for a single pixel; here five are compared, and errors of poses have a
  // term of their own (line_sigma).
  double intensity_sigma = 8;
  // Pixels: standard deviation of a pixel's distance from its epipolar line by errors of poses.
  double line_sigma = 0.5;
  double max_residual = 25;
  // Compatible hypotheses within a pixel: 95 % of chi² with 2 degrees of freedom.
  double chi2_pair = 5.99;
  // Compatible hypotheses of two keyframes: 95 % with 1 degree of freedom.
  double chi2_check = 3.84;
  // λ_N
  int min_compatible = 3;
  // Good maps have at most 0.035, pure rotation 0.07 and more.
  double max_landmark_difference = 0.05;

  bool fuse = true;
  bool smooth = true;
  bool cross_check = true;

  // Parallax from both sides.
  int delay = 2;
  double redo_baseline = 0.02;
  // Each waiting keyframe holds its image, 1.2 MB at 640 × 480 in color.
  int max_waiting = 200;
  double voxel = 0.005;

  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
