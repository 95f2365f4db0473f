// Best matches of edge pixels along their epipolar lines, several pixels at once, in plain values.
// All versions give the same bits. EpipolarSearch is the interface for others.
#pragma once

#include <cstddef>
#include <cstdint>

#include "alidade/base/cpu.h"

namespace alidade {

inline constexpr int kMostLanes = 8;         // pixels searched at once, at most
inline constexpr int kMostIntervals = 3;     // searched per pixel, at most
inline constexpr int kDirectionSteps = 252;  // steps of direction in a full circle

struct Plane {
  const uint8_t* data;  // of the first pixel
  ptrdiff_t row;        // bytes from a row to the next
};

// A reference image and the one that is searched, both of one camera.
struct LinePair {
  int width, height;
  float at_infinity[3][3];  // maps a pixel of the reference at infinity to the other image
  float shift[3];           // displacement per inverse depth in the other image, homogeneous
  float epipole[3];         // in the reference, homogeneous
  float least_cosine;       // of the angle between line and gradient
  // Gradient direction in the other image: turned by `turn`, give or take `max_turn`; in steps.
  int turn, max_turn;
  float noise;          // standard deviation of intensity, gray levels
  float line_sigma;     // of the distance from the line, pixels
  float max_residual2;  // mean square, gray levels
  // Intensity and gradient of each pixel, a byte each. `turned`: `other` with rows and columns
  // exchanged: two pixels one above the other are neighbors in memory here.
  Plane reference, other, turned;
  Plane direction;  // of the other image, a byte each; from kDirectionSteps on: unusable
};

struct LineQueries {
  int count = 0;      // pixels
  int intervals = 0;  // the largest number of a pixel
  float x[kMostLanes], y[kMostLanes];
  float gradient_x[kMostLanes], gradient_y[kMostLanes];  // unit length
  int gradient_step[kMostLanes];                         // its direction
  // Inverse depth: the k-th interval of each pixel, empty where it has fewer; and from the lowest
  // to the highest end of a pixel's.
  float min[kMostIntervals][kMostLanes], max[kMostIntervals][kMostLanes];
  float lowest[kMostLanes], highest[kMostLanes];
};

struct LineAnswers {
  float inverse_depth[kMostLanes], sigma[kMostLanes];  // sigma 0: unknown
  int searches, samples;                               // lines searched, positions compared
};

using LineSearch = void (*)(const LinePair& pair, const LineQueries& queries, LineAnswers& answers);

// Four pixels at once.
void LineSearch4(const LinePair& pair, const LineQueries& queries, LineAnswers& answers);

#ifdef ALIDADE_AVX2
// Eight pixels at once, with AVX2.
void LineSearch8(const LinePair& pair, const LineQueries& queries, LineAnswers& answers);
#endif

}  // namespace alidade
