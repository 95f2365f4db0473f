// Inverse depth of a keyframe's edge pixels from one other keyframe: best match along each epipolar
// line (Mur-Artal & Tardós, RSS 2015, §III-A).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "alidade/geometry/camera.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"
#include "alidade/semidense/report.h"
#include "alidade/semidense/settings.h"

namespace alidade {

// A reference keyframe and the keyframe that is searched.
struct EpipolarPair {
  const GradientImage* reference = nullptr;
  const GradientImage* other = nullptr;
  cv::Mat values;  // of the reference, adapted to the exposure of `other`
  Se3 T_other_reference;
};

// Searches the epipolar lines of one pair, one at a time. Not thread-safe.
class EpipolarSearch {
 public:
  EpipolarSearch(const EpipolarPair& pair, const Camera& camera, const SemiDenseSettings& settings);

  // Best match of an edge pixel of the reference within any of the intervals. Unknown if depth is
  // not observable along the line or no match is good enough.
  Hypothesis Search(const EdgePixel& pixel, std::span<const DepthInterval> intervals,
                    SearchCount& count);

 private:
  static constexpr int kHalf = 2;  // the pattern has 2 kHalf + 1 samples along the line
  static constexpr int kPattern = 2 * kHalf + 1;
  static constexpr int kMargin = kHalf + 1;  // samples needed beyond the compared positions
  static constexpr int kMaxPlaces = 256;     // positions compared per interval, at most
  static constexpr int kLanes = 4;           // positions compared in parallel

  struct Line {
    Eigen::Vector3f a;          // pixel in the other image = a + inverse depth * b_, homogeneous
    Eigen::Vector2f direction;  // in the reference, unit length
    float cosine = 0;           // of the angle between line and gradient
    int gradient_step = 0;      // direction of the gradient, in steps
    // Pixels along the line in the other image per pixel in the reference.
    float stretch = 0;
  };
  struct Match {
    int32_t cost = -1;                           // -1: none yet
    int place = 0;                               // whole pixel along the axis
    float across = 0, slope = 0;                 // the line at that position
    std::array<uint32_t, kPattern + 2> samples;  // around the position
  };

  DepthInterval InFront(DepthInterval interval, float a_z) const;
  bool Prepare(const EdgePixel& pixel, const DepthInterval& whole, Line& line);
  bool TakePattern(const EdgePixel& pixel, const Line& line);
  void SearchInterval(const Line& line, const DepthInterval& interval, SearchCount& count,
                      Match& match);
  int LeastCost(int places);
  void WalkLine(int first, int places, float across, float slope);
  Hypothesis Refine(const Line& line, const Match& match) const;

  const EpipolarPair& pair_;
  const SemiDenseSettings& settings_;
  Eigen::Matrix3f M_;  // maps a reference pixel at infinity to the other image
  // Displacement per inverse depth in the other image; the epipole in the reference.
  Eigen::Vector3f b_, epipole_;
  float least_cosine_;  // smallest cosine of the angle between gradient and line
  // Rotation of the image about the optical axis, and tolerance of gradient directions; in
  // direction steps.
  int turn_, max_turn_;
  int width_, height_;
  int axis_ = 0;  // axis along which positions are counted: 0 columns, 1 rows
  // Samples: intensity in the low half, gradient in the high half.
  std::array<uint32_t, kPattern> pattern_{};
  std::array<uint32_t, kMaxPlaces + 2 * kMargin + kLanes> line_{};
  int32_t least_cost_ = 0;
};

}  // namespace alidade
