// Orientation and 256-bit steered descriptor of the patch around a corner. Rublee et al. 2011, §4.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/features/descriptor.h"

namespace alidade {

// Pixels the patch reaches from its centre, for both the orientation and the rotated sampling
// pattern.
inline constexpr int kPatchRadius = 15;
inline constexpr int kPatternReach = 16;  // pixels, after rounding at any angle

// Direction from the patch's centre to its intensity centroid, radians in (-pi, pi]. `level` is not
// blurred; (x, y) at least kPatchRadius + 1 pixels from its sides.
float PatchAngle(const cv::Mat& level, int x, int y);

// The image a level's descriptors are read from: smoothed so that single pixels' noise decides no
// bit.
void SmoothForDescriptors(const cv::Mat& level, cv::Mat& smooth);

// The sampling pattern turned to kTurns directions, as offsets into images of one row stride.
class SteeredPattern {
 public:
  static constexpr int kTurns =
      128;  // 2.8°: at most 0.4 pixels at the rim, below the rounding to whole pixels
  explicit SteeredPattern(int stride);  // bytes
  int stride() const { return stride_; }
  // Bit i of the result: the pixel at the first place of pair i is darker than the one at the
  // second. `centre`: at least kPatternReach pixels from the sides of a smoothed image.
  Descriptor Describe(const uint8_t* centre, float angle) const;

 private:
  int stride_;
  std::vector<int> offsets_;  // [turn][bit][end], bytes
};

}  // namespace alidade
