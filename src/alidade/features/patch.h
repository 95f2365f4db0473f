// Small squares of an image that are found again in another image to a fraction of a pixel, by the
// inverse compositional method (Baker & Matthews 2004) with gain and offset of the brightness.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// `count` images, each half as wide and high as the one before; the first shares the data of
// `image` (8-bit gray). Fewer where a side would be shorter than 16 pixels. Coordinates are
// converted by FromLevelZero() and ToLevelZero() (pyramid.h) with scale 2^level.
std::vector<cv::Mat> HalvedImages(const cv::Mat& image, int count);

// kSide x kSide pixels as they should appear in another image, row by row.
struct Patch {
  static constexpr int kSide = 8, kPixels = kSide * kSide;
  // From the middle of the patch to the farthest pixel that is read, including gradients.
  static constexpr float kReach = kSide / 2 + 1;
  alignas(16) std::array<float, kPixels> value;   // gray levels minus their mean
  alignas(16) std::array<float, kPixels> dx, dy;  // derivatives, gray levels per pixel
  // Inverse of Σ j j' over the pixels, j = (dx, dy, value, 1).
  Eigen::Matrix4f inverse;
  // Information about a shift in x and y, where gain and offset are unknown: the inverse of the
  // first 2x2 block of `inverse`. (gray levels per pixel)².
  Eigen::Matrix2f information;
};

// Samples the patch around `center` (pixels of `image`). `warp`: pixels of `image` per pixel of the
// image in which the patch will be looked for. False, and the patch is undefined, if it reaches
// beyond the image or does not tell both coordinates.
bool CutPatch(const cv::Mat& image, const Eigen::Vector2f& center, const Eigen::Matrix2f& warp,
              Patch& patch);

// Whether the pixels of a patch around `place` are in the image.
bool HoldsPatch(const cv::Mat& image, const Eigen::Vector2f& place);

// One step of the alignment of a patch with the pixels around a place.
struct PatchStep {
  bool inside = false;  // the place is far enough from the image's border; otherwise nothing is set
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();  // from the place to the patch, pixels
  float gain = 0;                                   // of the image relative to the patch; unitless
  float correlation = 0;  // of the pixels and the patch shifted to the first order, -1 to 1
  float residual2 = 0;    // mean squared difference left by shift, gain and offset, gray levels²
};
PatchStep StepOf(const Patch& patch, const cv::Mat& image, const Eigen::Vector2f& place);

// Repeats the step until it is shorter than kAligned pixels. False if it does not end in
// kPatchSteps, leads more than `reach` pixels away, or ends where the correlation is below
// `min_correlation`. `place` is changed.
constexpr float kAligned = 0.02f;
constexpr int kPatchSteps = 10;
bool AlignPatch(const Patch& patch, const cv::Mat& image, float reach, float min_correlation,
                Eigen::Vector2f& place);

}  // namespace alidade
