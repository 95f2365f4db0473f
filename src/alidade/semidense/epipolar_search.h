// Inverse depth of a keyframe's edge pixels from one other keyframe: the best match along each
// epipolar line (Mur-Artal & Tardós, RSS 2015, §III-A).
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

// From a keyframe to another that is searched.
struct EpipolarPair {
  const GradientImage* reference = nullptr;
  const GradientImage* other = nullptr;
  cv::Mat values;  // of the reference, as the other's exposure would have made them
  Se3 T_other_reference;
};

// The lines of one pair, one after the other.
class EpipolarSearch {
 public:
  EpipolarSearch(const EpipolarPair& pair, const Camera& camera, const SemiDenseSettings& settings);

  // The best match of an edge pixel of the reference within any of the intervals. Nothing where the
  // line says little or none is convincing.
  Hypothesis Search(const EdgePixel& pixel, std::span<const DepthInterval> intervals,
                    SearchCount& count);

 private:
  static constexpr int kHalf = 2;  // the pattern compared is 2 kHalf + 1 samples along the line
  static constexpr int kPattern = 2 * kHalf + 1;
  static constexpr int kMargin = kHalf + 1;  // samples needed beyond the places compared
  static constexpr int kMaxPlaces = 256;     // compared in one interval, at most: pixels
  static constexpr int kLanes = 4;           // places compared at once

  struct Line {
    Eigen::Vector3f a;          // pixel in the other image = a + inverse depth * b_, homogeneous
    Eigen::Vector2f direction;  // in the reference, unit
    float cosine = 0;           // of the angle between it and the gradient
    int gradient_step = 0;      // the gradient's direction
    float stretch = 0;  // places on the line in the other image for a pixel in the reference
  };
  struct Match {
    int32_t cost = -1;                           // none yet
    int place = 0;                               // whole pixel along the axis
    float across = 0, slope = 0;                 // the line there
    std::array<uint32_t, kPattern + 2> samples;  // around it
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
  Eigen::Matrix3f M_;  // pixel of the reference at infinity to the other's
  Eigen::Vector3f b_,
      epipole_;         // other camera's shift by inverse depth; its centre in the reference
  float least_cosine_;  // of the angle between gradient and line
  int turn_,
      max_turn_;  // of the picture in its plane, and allowed beside it; in steps of directions
  int width_, height_;
  int axis_ = 0;  // that places are counted along: 0 columns, 1 rows
  // Samples: intensity in the lower half, gradient in the upper.
  std::array<uint32_t, kPattern> pattern_{};
  std::array<uint32_t, kMaxPlaces + 2 * kMargin + kLanes> line_{};
  int32_t least_cost_ = 0;
};

}  // namespace alidade
