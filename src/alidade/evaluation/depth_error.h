// How good the depth of keyframes is, measured against true depth: relative errors, and how much of
// the image and of its edges carries depth at all.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// One keyframe's depth beside the truth, both along z. The estimate may be smaller than the others:
// it is judged at its own resolution.
struct DepthFrame {
  cv::Mat estimate;  // CV_32F in the map's unit; 0 (or no number) = none
  cv::Mat truth;     // CV_32F, metres; 0 (or no number) = unknown
  cv::Mat image;     // CV_8U, of the truth's size: its gradients and edges
  int map = 0;       // maps that were never joined have a unit each; 0 is the main one
};

struct DepthErrorSettings {
  // One camera knows no metres: each map's unit is fitted, as the median of truth / estimate over
  // all its pixels that have both.
  bool fit_scale = false;
  // Grey levels per pixel (Scharr / 32): where the semi-dense map is asked for depth, as in
  // semidense.min_gradient.
  double min_gradient = 8;
  // A pixel's truth is continuous when all that is known of the truth in the window around it is
  // this close to its own, as a share: sensors read badly beside depth steps.
  double continuity = 0.05;
  int continuity_window = 15;  // pixels of the truth, odd
  void Check() const;          // throws Error (usage) naming the field that cannot be
};

// Of one keyframe or all together. The error is |scale * estimate - truth| / truth at each pixel
// that has both. NaN: nothing to tell it by. Shares are from 0 to 1.
struct DepthScore {
  int64_t n = 0;          // pixels with both
  double median_rel = 0;  // of an even number: the mean of the middle two
  double p90_rel = 0;     // the smallest that 90 % do not exceed
  double within_2 = 0, within_5 = 0, within_10 = 0;  // share of errors up to 2, 5, 10 %
  double rmse_inv = 0;                               // of inverse depth, 1/m
  double scale = 1;  // metres per unit; all maps: that of the main one
  // These ask for no truth.
  double density = 0;           // share of all image pixels that carry depth
  double density_gradient = 0;  // the same of those with min_gradient
  // Share of edge pixels (local maxima of the gradient across the edge, above min_gradient) that
  // carry depth, themselves or one of their eight neighbours.
  double edge_coverage = 0;
};

// The same estimates, their errors taken at all pixels or only where the truth is continuous. The
// scale is fitted to all in either case.
struct DepthScores {
  DepthScore all, continuous;
};

struct DepthErrorResult {
  DepthScores overall;              // over the pixels of all frames, not the mean of their scores
  std::vector<DepthScores> frames;  // as they were added
  std::vector<double> scales;       // of each map, metres per unit; NaN when nothing tells it
};

// Takes one frame after the other, so that not all images need be held at once.
class DepthScorer {
 public:
  explicit DepthScorer(const DepthErrorSettings& settings = {});
  // Throws Error (input) when sizes or types do not fit.
  void Add(const DepthFrame& frame);
  DepthErrorResult Result() const;

 private:
  struct Pair {
    float estimate, truth;
  };
  struct Coverage {
    int64_t all = 0, with_depth = 0;  // pixels
  };
  struct Frame {
    int map = 0;
    std::vector<Pair> continuous, other;
    Coverage pixels, gradient, edge;
  };
  static DepthScore Score(std::span<const Frame> frames, const std::vector<double>& scales,
                          bool continuous_only);
  static double ShareWithDepth(std::span<const Frame> frames, Coverage Frame::*which);
  std::vector<double> Scales() const;

  DepthErrorSettings settings_;
  std::vector<Frame> frames_;
};

DepthErrorResult ScoreDepth(std::span<const DepthFrame> frames,
                            const DepthErrorSettings& settings = {});

}  // namespace alidade
