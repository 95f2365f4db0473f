// The residual all of this folder minimises: where a point would be seen minus where it was, and
// its derivative by the point in the camera frame. Pixel u, v as in Mur-Artal & Tardós 2017, eq. 2
// and 4, but depth as disparity u - u_right, not as u_right: what shifts a keypoint (blur, a
// rolling shutter) shifts both columns alike, so that disparity is known far better than either.
#pragma once

#include <cmath>

#include "alidade/geometry/camera.h"

namespace alidade {

// Points nearer than this, or behind, have no projection. Map units.
inline constexpr double kMinDepth = 1e-6;

struct Intrinsics {
  double fx, fy, cx, cy;  // pixels
  double bf;              // pixels × map units: disparity = bf / z

  static Intrinsics Of(const Camera& camera) {
    return {camera.fx, camera.fy, camera.cx, camera.cy, camera.bf()};
  }
};

// Derivative rows by (x, y, z): u: (u_x, 0, u_z); v: (0, v_y, v_z); disparity: (0, 0, d_z).
template <typename T>
struct Reprojection {
  T u, v, d;  // residuals, pixels
  T u_x, v_y, u_z, v_z, d_z;
};

// T: double, or an Eigen array of several points side by side. z > 0. Inlined whatever the compiler
// thinks: as a call it is most of the time of the loops around it.
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

// Whether a measured u_right counts: NaN says there is none, and without a baseline it says
// nothing.
inline bool HasRight(const Intrinsics& k, double seen_right) {
  return std::isfinite(seen_right) && k.bf > 0;
}

}  // namespace alidade
