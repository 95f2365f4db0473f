// Epipolar lines of edge pixels in another keyframe: where they run, and which part of them an
// interval of depth covers (Mur-Artal & Tardós, RSS 2015, §III-A). Four pixels at once, one per
// lane of a vector.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/semidense/hypothesis.h"
#include "alidade/semidense/lanes.h"

namespace alidade {

// The pattern that is compared: 2 kHalf + 1 samples, on the line and around the pixel.
inline constexpr int kHalf = 2;
inline constexpr int kLineMargin = kHalf + 1;  // samples needed beyond the compared positions
inline constexpr int kMaxPlaces = 256;         // positions compared per interval, at most

struct EdgeLanes {
  Lanes<float> x, y;                    // pixels
  Lanes<float> gradient_x, gradient_y;  // unit length
  Lanes<float> min, max;                // inverse depth: all intervals to be searched are within
};

struct EpipolarLines {
  // Pixel in the other image = a + inverse depth * shift, homogeneous.
  Floats a_x, a_y, a_z;
  Floats rows;    // mask: positions are counted along rows (y), else along columns (x)
  Floats cosine;  // of the angle between line and gradient
  // Distance of two samples of the pattern in the reference: as far as two samples of the line are
  // apart in the other image. Pixels with kFixed fractional bits.
  Lanes<int32_t> step_x, step_y;
  int usable = 0;  // bit per lane: depth is observable along the line, the pattern is in the image
};

// Part of each line, counted in whole pixels along its axis.
struct LineParts {
  Lanes<int32_t> first, places;  // positions to compare
  Lanes<float> across, slope;    // position across the axis at the first one; change per pixel
  // Of the first sample, kLineMargin before the first position; with kFixed fractional bits.
  Lanes<int32_t> fixed_across, fixed_slope;
  int usable = 0;  // bit per lane: there is something to compare
};

// Both images are those of one camera.
class EpipolarGeometry {
 public:
  // `max_edge_angle`: degrees between line and gradient.
  EpipolarGeometry(const Camera& camera, const Se3& T_other_reference, double max_edge_angle);

  EpipolarLines Lines(const EdgeLanes& edges) const;
  // `min`, `max`: interval of inverse depth of each line.
  LineParts Parts(const EpipolarLines& lines, const Floats& min, const Floats& max) const;
  // Displacement per inverse depth in the other image, homogeneous.
  const Eigen::Vector3f& shift() const { return shift_; }

 private:
  struct Interval {
    Floats min, max;
  };
  struct Ends {  // of an interval on the line: position, and homogeneous
    Floats from_x, from_y, to_x, to_y;
  };
  Interval InFront(const Floats& min, const Floats& max, const Floats& a_z) const;
  Ends EndsOf(const EpipolarLines& lines, const Interval& seen) const;
  Floats Stretch(const EpipolarLines& lines, const Interval& seen, const Floats& direction_x,
                 const Floats& direction_y) const;

  Eigen::Matrix3f at_infinity_;  // maps a reference pixel at infinity to the other image
  Eigen::Vector3f shift_, epipole_;
  float least_cosine_;
  int width_, height_;
};

}  // namespace alidade
