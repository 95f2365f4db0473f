// Orientation and 256-bit steered BRIEF descriptor of the patch around a corner (Rublee et al.
// 2011, §4).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/descriptor.h"

namespace ALIDADE_API alidade {

inline constexpr int kPatchRadius = 15;   // pixels, disc used for the orientation
inline constexpr int kPatternReach = 18;  // pixels, disc that contains the sampling pattern

// Direction from the patch center to its intensity centroid, radians in (-π, π]. (x, y) must be at
// least kPatchRadius + 1 pixels from the sides of `level`.
float PatchAngle(const cv::Mat& level, int x, int y);

// The sampling pattern rotated to kTurns directions, as byte offsets into images with one row
// stride.
class SteeredPattern {
 public:
  // 2.8° apart: an error of at most 0.44 pixels at the rim, less than rounding to whole pixels.
  static constexpr int kTurns = 128;
  explicit SteeredPattern(int stride);  // bytes
  int stride() const { return stride_; }
  // Bit i is set if the pixel at the first end of pair i is darker than the one at the second end.
  // `centre` points into a smoothed image, at least kPatternReach pixels from its sides; `angle` is
  // in radians.
  Descriptor Describe(const uint8_t* centre, float angle) const;

 private:
  int stride_;
  std::vector<int> offsets_;  // [turn][bit][end], bytes
};

}  // namespace alidade
