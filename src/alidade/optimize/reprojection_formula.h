// The reprojection residual used in this folder, predicted minus observed position, and its
// derivative by the point in the camera frame. u and v as in Mur-Artal & Tardós 2017, eq. 2 and 4.
// Depth enters as disparity u - u_right instead of u_right: blur or rolling shutter shifts both
// columns equally, so the disparity is much more accurate than either column.
// Includes nothing, so that files for other processors can (cpu.h).
#pragma once

namespace alidade {

// Smallest depth with a valid projection, map units.
inline constexpr double kMinDepth = 1e-6;

// Derivatives by (x, y, z): u: (u_x, 0, u_z); v: (0, v_y, v_z); disparity: (0, 0, d_z).
template <typename T>
struct Reprojection {
  T u, v, d;  // residuals, pixels
  T u_x, v_y, u_z, v_z, d_z;
};

// T is double or a vector of several points, Lens is Intrinsics. Requires z > 0. Inlining is
// forced: a call would dominate the loops around it.
template <typename T, typename Lens>
[[gnu::always_inline]] inline Reprojection<T> Reproject(const Lens& k, const T& x, const T& y,
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

}  // namespace alidade
