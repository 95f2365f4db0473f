// ORB feature extraction: image pyramid, evenly distributed FAST corners, orientation, steered
// binary descriptors (Rublee et al. 2011; even distribution as in Mur-Artal, Montiel & Tardós 2015,
// §VI-A).
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "alidade/base/api.h"
#include "alidade/features/describe.h"
#include "alidade/features/fast.h"
#include "alidade/features/frame.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in extractor.cc.
struct ExtractorSettings {
  int features = 1000;
  int fast_threshold = 14;
  // Pixel noise of 4 grey levels stays below.
  int min_fast_threshold = 6;
  int cell = 32;
  // Pixels kept free on every level: the descriptor's patch must fit.
  int border = 19;
  // 0: the strongest corners; 1: spread as evenly as possible, with weak ones among them.
  double evenness = 0.45;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

// Keeps buffers between frames: one instance per image stream, used by one thread at a time.
class Extractor {
 public:
  explicit Extractor(ExtractorSettings settings = {});

  // Returns the frame's keypoints, sorted by level, row, column, and their descriptors. `image` is
  // 8-bit gray, of the camera's size, continuous or not. Keypoint positions are undistorted with
  // `camera`; raw_x and raw_y keep the image position. `avoid` (CV_8U of any size, stretched over
  // the image; may be empty) marks by nonzero values where keypoints are of little use: only a few
  // are taken there, in addition to the full budget elsewhere. The result does not depend on the
  // number of threads. An image without structure gives an empty frame.
  Frame Extract(const cv::Mat& image, const Camera& camera, double time, int number,
                const cv::Mat& avoid = {}) {
    return ExtractFrom(image.clone(), camera, time, number, avoid, false);
  }
  // The same without copies: the frame's image is `image`, and its pyramid is overwritten by the
  // next call.
  Frame ExtractInPlace(const cv::Mat& image, const Camera& camera, double time, int number,
                       const cv::Mat& avoid = {}) {
    return ExtractFrom(image, camera, time, number, avoid, true);
  }

  struct Band {
    int level, first_row, end_row;
  };

 private:
  // `reuse`: the pyramid of the last call is overwritten.
  Frame ExtractFrom(const cv::Mat& image, const Camera& camera, double time, int number,
                    const cv::Mat& avoid, bool reuse);
  void PrepareBuffers(const std::vector<cv::Size>& sizes);
  // Smooths the band's rows into both buffers and returns its corners.
  void Smooth(const cv::Mat& level, const Band& band, int top, cv::Mat& fine);
  std::vector<Corner> LookThrough(const cv::Mat& level, const Band& band);

  ExtractorSettings settings_;
  // All levels stacked in one image each, with a common row stride: lightly smoothed for corners,
  // more strongly for descriptors.
  std::vector<cv::Mat> fine_, smooth_;
  std::vector<cv::Mat> pyramid_;           // of the last ExtractInPlace()
  std::optional<SteeredPattern> pattern_;  // for that row stride
};

// Sets the depth of every keypoint from a registered depth image (CV_16U in units of 1 /
// depth_factor, or CV_32F in meters), read at the raw position, and right_x = x - bf / depth. A
// keypoint keeps no depth if there is no reading, if the depths of its 3x3 neighborhood differ by
// more than 5 % (depth discontinuity), or if the depth exceeds `range` (meters), where some sensors
// report a constant. Throws Error (input) if type, size or depth_factor do not fit.
void ReadDepths(const cv::Mat& depth, const Camera& camera, Frame& frame,
                double range = std::numeric_limits<double>::infinity());
// The same, and Frame::nearest.
void AttachDepth(const cv::Mat& depth, const Camera& camera, Frame& frame,
                 double range = std::numeric_limits<double>::infinity());

// Sets right_x and depth of the keypoints of a rectified left image from the right one, extracted
// with the same settings. For each keypoint: best Hamming distance along its row, sum of absolute
// differences (SAD), least-squares alignment for sub-pixel disparity; then outliers by median SAD
// are dropped. Both frames need their pyramids. Throws Error if they are missing (usage) or the
// images differ in size (input).
void MatchStereo(const Frame& right, const Camera& camera, Frame& left);

}  // namespace alidade
