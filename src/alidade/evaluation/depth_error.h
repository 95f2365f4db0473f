// Errors of keyframes' depth relative to ground truth, and the share of the image and of its edges
// that has depth.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// One keyframe's estimated and true depth, both along z. A smaller estimate is compared at its own
// resolution.
struct DepthFrame {
  cv::Mat estimate;  // CV_32F in the map's unit; 0 or not finite: no depth
  cv::Mat truth;     // CV_32F, meters; 0 or not finite: unknown
  cv::Mat image;     // CV_8U, the truth's size: for gradients and edges
  // Index of the map, as maps that were not joined have different units; 0: the main map.
  int map = 0;
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

// Scores of one keyframe or of all. The error is |scale * estimate - truth| / truth at each pixel
// that has both. NaN: no data. Shares are between 0 and 1.
struct DepthScore {
  int64_t n = 0;          // pixels that have both depths
  double median_rel = 0;  // the mean of the middle two for an even number
  double p90_rel = 0;     // the smallest value that 90 % do not exceed
  double within_2 = 0, within_5 = 0, within_10 = 0;  // share of errors up to 2, 5, 10 %
  double rmse_inv = 0;                               // of inverse depth, 1/m
  double scale = 1;  // meters per unit; for all maps: that of the main map
  // The following do not depend on ground truth.
  double density = 0;  // share of all image pixels with depth
  // Share of pixels with a gradient of at least min_gradient that have depth.
  double density_gradient = 0;
  // Share of edge pixels (local maxima of the gradient across the edge, above min_gradient) that
  // have depth themselves or at one of their eight neighbors.
  double edge_coverage = 0;
};

// Errors at all pixels and at pixels with continuous true depth. The scale is fitted to all pixels
// in both cases.
struct DepthScores {
  DepthScore all, continuous;
};

struct DepthErrorResult {
  DepthScores overall;  // over the pixels of all frames, not the mean of the frames' scores
  std::vector<DepthScores> frames;  // in the order of Add()
  std::vector<double> scales;       // of each map, meters per unit; NaN when there is no data
};

// Adds frames one after the other, so that not all images need to be in memory.
class DepthScorer {
 public:
  explicit DepthScorer(const DepthErrorSettings& settings = {});
  // Throws Error (input) when sizes or types do not match.
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
