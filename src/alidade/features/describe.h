// Orientation and 256-bit steered descriptor of the patch around a corner. Rublee et al. 2011, §4.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/descriptor.h"

namespace ALIDADE_API alidade {

inline constexpr int kPatchRadius = 15;   // pixels, of the disc that gives the orientation
inline constexpr int kPatternReach = 18;  // pixels, of the disc that holds the sampling pattern

// Direction from the patch's centre to its intensity centroid, radians in (-pi, pi]. (x, y) at
// least kPatchRadius + 1 pixels from the sides of `level`.
float PatchAngle(const cv::Mat& level, int x, int y);

// The sampling pattern turned to kTurns directions, as offsets into images of one row stride.
class SteeredPattern {
 public:
  // 2.8° apart: at most 0.44 pixels off at the rim, less than the rounding to whole pixels.
  static constexpr int kTurns = 128;
  explicit SteeredPattern(int stride);  // bytes
  int stride() const { return stride_; }
  // Bit i: the pixel at the first end of pair i is darker than the one at the second.
  // `centre`: at least kPatternReach pixels from the sides of a smoothed image.
  Descriptor Describe(const uint8_t* centre, float angle) const;

 private:
  int stride_;
  std::vector<int> offsets_;  // [turn][bit][end], bytes
};

}  // namespace alidade
