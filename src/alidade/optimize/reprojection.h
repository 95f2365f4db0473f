// The reprojection residual used in this folder, predicted minus observed position, and its
// derivative by the point in the camera frame. u and v as in Mur-Artal & Tardós 2017, eq. 2 and 4.
// Depth enters as disparity u - u_right instead of u_right: blur or rolling shutter shifts both
// columns equally, so the disparity is much more accurate than either column.
#pragma once

#include <cmath>

#include "alidade/geometry/camera.h"

namespace alidade {

// Smallest depth with a valid projection, map units.
inline constexpr double kMinDepth = 1e-6;

struct Intrinsics {
  double fx, fy, cx, cy;  // pixels
  double bf;              // pixels × map units: disparity = bf / z

  static Intrinsics Of(const Camera& camera) {
    return {camera.fx, camera.fy, camera.cx, camera.cy, camera.bf()};
  }
};

// Derivatives by (x, y, z): u: (u_x, 0, u_z); v: (0, v_y, v_z); disparity: (0, 0, d_z).
template <typename T>
struct Reprojection {
  T u, v, d;  // residuals, pixels
  T u_x, v_y, u_z, v_z, d_z;
};

// T is double or a vector of several points. Requires z > 0. Inlining is forced: a call would
// dominate the loops around it.
template <typename T>
[[gnu::always_inline]] inline Reprojection<T> Reproject(const Intrinsics& k, const T& x, const T& y,
                                                        const T& z, const T& seen_u,
                                                        const T& seen_v, const T& seen_right) {
  Reprojection<T> e;
  const T inv_z = 1.0 / z;
  e.u_x = k.fx * inv_z;
  e.v_y = k.fy * inv_z;
  const T u = e.u_x * x, v = e.v_y * y, disparity = k.bf * inv_z;
  e.u = u + k.cx - seen_u;
  e.v = v + k.cy - seen_v;
  e.d = disparity - (seen_u - seen_right);
  e.u_z = -(u * inv_z);
  e.v_z = -(v * inv_z);
  e.d_z = -(disparity * inv_z);
  return e;
}

// True if a measured u_right is usable: it is finite (NaN means none) and the camera has a
// baseline.
inline bool HasRight(const Intrinsics& k, double seen_right) {
  return std::isfinite(seen_right) && k.bf > 0;
}

}  // namespace alidade
