// From an image to a Frame: pyramid, FAST corners spread evenly, orientation, steered binary
// descriptors. Rublee et al. 2011 (ORB); even spread as in Mur-Artal, Montiel & Tardós 2015, §VI-A.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "alidade/base/api.h"
#include "alidade/features/describe.h"
#include "alidade/features/fast.h"
#include "alidade/features/frame.h"

namespace ALIDADE_API alidade {

struct ExtractorSettings {
  int features = 1000;      // wanted per image, over all levels
  int fast_threshold = 14;  // grey levels of the lightly smoothed level; first try in each cell
  int fast_minimum = 6;  // grey levels; second try in cells the first left empty. Pixel noise of 4
                         // grey levels stays below
  int cell = 32;         // pixels, side of a detection cell on every level
  int border = 19;       // pixels kept free on every level: the descriptor's patch must fit
  double evenness =
      0.45;  // 0: the strongest corners; 1: as evenly spread as can be, at the price of weak ones
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// One instance per stream: keeps buffers between frames. Extract() is not re-entrant.
class Extractor {
 public:
  explicit Extractor(ExtractorSettings settings = {});

  // `image`: 8 bit grey, continuous or not, of the camera's size. Keypoints are undistorted with
  // `camera` (raw_x, raw_y keep the image position) and sorted by level, then row, then column. The
  // result does not depend on the number of threads. A structureless image gives an empty frame.
  // `avoid` (CV_8U, of any size, laid over the image; may be empty): where it is not 0 keypoints
  // are of little use. All that are wanted are then found elsewhere, and only a few there.
  Frame Extract(const cv::Mat& image, const Camera& camera, double time, int number,
                const cv::Mat& avoid = {});

  struct Band {
    int level, first_row, end_row;
  };

 private:
  void PrepareBuffers(const std::vector<cv::Size>& sizes);
  // Fills the band's rows of both buffers and finds its corners.
  std::vector<Corner> LookThrough(const cv::Mat& level, const Band& band);

  ExtractorSettings settings_;
  // Every level lightly smoothed, for corners, and more so, for descriptors; one row stride for
  // all.
  std::vector<cv::Mat> fine_, smooth_;
  std::optional<SteeredPattern> pattern_;  // for that stride
};

// Gives every keypoint its depth from a registered depth image (CV_16U in depth_factor units per
// metre or CV_32F in metres), read at its raw position, and right_x = x - bf / depth. Left without
// depth: no reading, or a 3x3 neighbourhood that spreads more than 5 % (an edge: foreground and
// background mix there), or farther than `range` (metres): there a depth camera measures nothing,
// and may say so by a number.
void AttachDepth(const cv::Mat& depth, const Camera& camera, Frame& frame,
                 double range = std::numeric_limits<double>::infinity());

// Finds every keypoint of the rectified left image along its row in the right one (extracted with
// the same settings): Hamming distance, then sum of absolute differences, then an alignment by
// least squares for sub-pixel disparity, then outliers by the median SAD. Fills right_x and depth.
// Needs both pyramids.
void MatchStereo(const Frame& right, const Camera& camera, Frame& left);

}  // namespace alidade
