#include "alidade/io/ros/camera_info.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/calibrations/lens_fit.h"

namespace alidade {
namespace {

bool AllFinite(const CameraInfo& info) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(info.D.begin(), info.D.end(), finite) &&
         std::all_of(info.K.begin(), info.K.end(), finite) &&
         std::all_of(info.P.begin(), info.P.end(), finite) &&
         std::all_of(info.R.begin(), info.R.end(), finite);
}

// Returns what was approximated, for the user.
std::string SetLens(const CameraInfo& info, RawCamera& camera) {
  const std::string& model = info.distortion_model;
  const bool none = std::all_of(info.D.begin(), info.D.end(), [](double d) { return d == 0; });
  if (model == "equidistant" || model == "fisheye" || model == "kannala_brandt4") {
    camera.lens = Lens::kFisheye;  // also without coefficients
    for (size_t i = 0; i < 4 && i < info.D.size(); ++i) camera.distortion[i] = info.D[i];
    return {};
  }
  if (none) return {};  // no distortion, whatever the model
  if (model.empty() || model == "plumb_bob" || model == "radtan" || model == "radial-tangential" ||
      model == "rational_polynomial") {
    // Drivers write plumb_bob above eight coefficients: their number says what they are.
    return SetOpenCvLens(info.D, camera);
  }
  ThrowInput("has the distortion_model `" + model.substr(0, 40) +
             "`; supported are plumb_bob, rational_polynomial and equidistant");
}

// K and P refer to the full sensor image. Pixel centers are at integer coordinates.
void ApplyBinning(const CameraInfo& info, RawCamera& camera) {
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
Eigen::Matrix3d RotationOf(const CameraInfo& info) {
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.R.data());
  if (R.isZero()) return Eigen::Matrix3d::Identity();
  if (!(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0)
    ThrowInput("has an R that is not a rotation");
  return R;
}

bool SameCamera(const RawCamera& a, const RawCamera& b) {
  return a.lens == b.lens && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.distortion == b.distortion;
}

}  // namespace

std::optional<RawCamera> CameraOfInfo(const CameraInfo& info, bool rectified, std::string* told) {
  if (!AllFinite(info)) ThrowInput("has numbers that are not finite");
  rectified = rectified && info.P[0] != 0;
  RawCamera camera;
  camera.width = static_cast<int>(std::min<uint32_t>(info.width, kMostSide + 1));
  camera.height = static_cast<int>(std::min<uint32_t>(info.height, kMostSide + 1));
  camera.fx = rectified ? info.P[0] : info.K[0];
  camera.fy = rectified ? info.P[5] : info.K[4];
  camera.cx = rectified ? info.P[2] : info.K[2];
  camera.cy = rectified ? info.P[6] : info.K[5];
  if (camera.fx == 0) return std::nullopt;
  if (!(camera.fx > 0 && camera.fy > 0)) ThrowInput("has focal lengths that are not positive");
  if (!rectified) {
    const std::string approximated = SetLens(info, camera);
    if (told) *told = approximated;
  }
  ApplyBinning(info, camera);
  if (!(camera.fx > 0 && camera.fy > 0 && camera.width > 0 && camera.height > 0))
    ThrowInput("has an impossible size or binning");
  return camera;
}

bool AddRightCamera(const CameraInfo& left, const CameraInfo& right, bool rectified,
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
