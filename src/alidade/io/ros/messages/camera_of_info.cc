#include "alidade/io/ros/messages/camera_of_info.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/geometry/picture_size.h"

namespace alidade {
namespace {

// Pixels, the largest allowed error of the fit; about half the uncertainty of a keypoint.
constexpr double kMostMisfit = 0.5;
constexpr char kAdvice[] = " (use a camera file instead: --camera)";

bool AllFinite(const RosCameraInfo& info) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(info.D.begin(), info.D.end(), finite) &&
         std::all_of(info.K.begin(), info.K.end(), finite) &&
         std::all_of(info.P.begin(), info.P.end(), finite) &&
         std::all_of(info.R.begin(), info.R.end(), finite);
}

double Coefficient(const RosCameraInfo& info, size_t i) {
  return i < info.D.size() ? info.D[i] : 0;
}

// Least-squares fit of Brown's radial model 1 + k1 r² + k2 r⁴ + k3 r⁶ to OpenCV's rational model (1
// + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶) over the image, in pixels. The tangential
// terms are the same in both models. Throws Error (input) when the largest error exceeds
// kMostMisfit.
std::array<double, 5> BrownOfRational(const RosCameraInfo& info, const RawCamera& camera) {
  constexpr int kSteps = 64;
  const double u = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double v = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  // With barrel distortion the undistorted corner lies outside the distorted one. 1.25 times the
  // radius covers the lenses for which rational models are used.
  const double farthest = 1.25 * std::hypot(u, v);
  Eigen::Matrix<double, kSteps, 3> A;
  Eigen::Matrix<double, kSteps, 1> b;
  double last = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = farthest * (i + 1) / kSteps, r2 = r * r;
    const double up = 1 + r2 * (info.D[0] + r2 * (info.D[1] + r2 * info.D[4]));
    const double down = 1 + r2 * (info.D[5] + r2 * (info.D[6] + r2 * info.D[7]));
    const double bent = r * up / down;
    if (!(bent > last))
      ThrowInput("has a distortion that is not invertible within the image" + std::string(kAdvice));
    last = bent;
    const bool inside = bent <= std::hypot(u, v);  // points outside the image have no weight
    const double weight = inside ? 1 : 0;
    A.row(i) << weight * r * r2, weight * r * r2 * r2, weight * r * r2 * r2 * r2;
    b(i) = weight * (bent - r);
  }
  const Eigen::Vector3d k = A.colPivHouseholderQr().solve(b);
  const double misfit = (A * k - b).cwiseAbs().maxCoeff() * std::max(camera.fx, camera.fy);
  if (!(misfit <= kMostMisfit)) {
    char text[160];
    PrintTo(text, sizeof text,
            "has a rational_polynomial distortion that five coefficients approximate only to "
            "%.2g pixels: undistort the images first (image_proc)",
            misfit);
    ThrowInput(text);
  }
  return {k(0), k(1), info.D[2], info.D[3], k(2)};
}

void SetLens(const RosCameraInfo& info, RawCamera& camera) {
  const std::string& model = info.distortion_model;
  const bool none = std::all_of(info.D.begin(), info.D.end(), [](double d) { return d == 0; });
  if (model == "equidistant" || model == "fisheye" || model == "kannala_brandt4") {
    camera.lens = Lens::kFisheye;  // also without coefficients
    for (size_t i = 0; i < 4; ++i) camera.distortion[i] = Coefficient(info, i);
  } else if (none) {
    return;  // no distortion, whatever the model
  } else if (model.empty() || model == "plumb_bob" || model == "radtan" ||
             model == "radial-tangential" || model == "rational_polynomial") {
    // Drivers write plumb_bob above eight coefficients: their number says what they are.
    const auto zero_from = [&](size_t first) {
      return std::all_of(
          info.D.begin() + static_cast<std::ptrdiff_t>(std::min(first, info.D.size())),
          info.D.end(), [](double d) { return d == 0; });
    };
    if (!zero_from(8))
      ThrowInput("has distortion with thin prism or tilt terms" + std::string(kAdvice));
    if (zero_from(5)) {
      for (size_t i = 0; i < 5; ++i) camera.distortion[i] = Coefficient(info, i);
    } else if (info.D.size() >= 8) {
      camera.distortion = BrownOfRational(info, camera);
    } else {
      ThrowInput("has a rational_polynomial distortion with " + std::to_string(info.D.size()) +
                 " coefficients instead of 8" + kAdvice);
    }
  } else {
    ThrowInput("has the distortion_model `" + model.substr(0, 40) +
               "`; supported are plumb_bob, rational_polynomial and equidistant" + kAdvice);
  }
}

// K and P refer to the full sensor image. Pixel centers are at integer coordinates.
void ApplyBinning(const RosCameraInfo& info, RawCamera& camera) {
  if (info.roi_width > 0 && info.roi_height > 0) {
    camera.cx -= info.roi_x;
    camera.cy -= info.roi_y;
    camera.width = static_cast<int>(std::min<uint32_t>(info.roi_width, kMostSide + 1));
    camera.height = static_cast<int>(std::min<uint32_t>(info.roi_height, kMostSide + 1));
  }
  const double x = std::max<uint32_t>(info.binning_x, 1), y = std::max<uint32_t>(info.binning_y, 1);
  camera.fx /= x;
  camera.fy /= y;
  camera.cx = (camera.cx + 0.5) / x - 0.5;
  camera.cy = (camera.cy + 0.5) / y - 0.5;
  camera.width = static_cast<int>(camera.width / x);
  camera.height = static_cast<int>(camera.height / y);
}

// The message's R; all zeros (never set) counts as the identity.
Eigen::Matrix3d RotationOf(const RosCameraInfo& info) {
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.R.data());
  if (R.isZero()) return Eigen::Matrix3d::Identity();
  if (!(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0)
    ThrowInput("has an R that is not a rotation" + std::string(kAdvice));
  return R;
}

bool SameCamera(const RawCamera& a, const RawCamera& b) {
  return a.lens == b.lens && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.distortion == b.distortion;
}

}  // namespace

std::optional<RawCamera> CameraOfInfo(const RosCameraInfo& info, bool rectified) {
  if (!AllFinite(info)) ThrowInput("has numbers that are not finite" + std::string(kAdvice));
  rectified = rectified && info.P[0] != 0;
  RawCamera camera;
  camera.width = static_cast<int>(std::min<uint32_t>(info.width, kMostSide + 1));
  camera.height = static_cast<int>(std::min<uint32_t>(info.height, kMostSide + 1));
  camera.fx = rectified ? info.P[0] : info.K[0];
  camera.fy = rectified ? info.P[5] : info.K[4];
  camera.cx = rectified ? info.P[2] : info.K[2];
  camera.cy = rectified ? info.P[6] : info.K[5];
  if (camera.fx == 0) return std::nullopt;
  if (!(camera.fx > 0 && camera.fy > 0))
    ThrowInput("has focal lengths that are not positive" + std::string(kAdvice));
  if (!rectified) SetLens(info, camera);
  ApplyBinning(info, camera);
  if (!(camera.fx > 0 && camera.fy > 0 && camera.width > 0 && camera.height > 0))
    ThrowInput("has an impossible size or binning" + std::string(kAdvice));
  return camera;
}

bool AddRightCamera(const RosCameraInfo& left, const RosCameraInfo& right, bool rectified,
                    Calibration& calibration) {
  const std::optional<RawCamera> camera = CameraOfInfo(right, rectified);
  if (!camera || !(right.P[0] > 0)) return false;
  const double baseline = (left.P[0] > 0 ? left.P[3] / left.P[0] : 0) - right.P[3] / right.P[0];
  if (!(baseline > 0 && baseline < 100)) return false;
  const Eigen::Matrix3d R_left = RotationOf(left), R_right = RotationOf(right);
  const bool distorted = calibration.left.lens == Lens::kFisheye ||
                         calibration.left.distortion != std::array<double, 5>{};
  if (rectified || (!distorted && SameCamera(calibration.left, *camera) &&
                    R_left.isIdentity(1e-9) && R_right.isIdentity(1e-9))) {
    calibration.baseline = baseline;
    return true;
  }
  // Common frame c of the pair: p_c = R_left p_left = R_right p_right + (baseline, 0, 0).
  calibration.right = *camera;
  calibration.T_left_right = {R_left.transpose() * R_right,
                              R_left.transpose() * Eigen::Vector3d(baseline, 0, 0)};
  return true;
}

}  // namespace alidade
