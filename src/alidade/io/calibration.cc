#include "alidade/io/calibration.h"

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"

namespace alidade {
namespace {

Camera Unrectified(const Calibration& calibration) {
  const RawCamera& raw = calibration.left;
  Camera camera;
  camera.width = raw.width;
  camera.height = raw.height;
  camera.fx = raw.fx;
  camera.fy = raw.fy;
  camera.cx = raw.cx;
  camera.cy = raw.cy;
  camera.distortion = raw.distortion;
  return camera;
}

// Checked first, because the rectification maps have this size.
void CheckSize(const RawCamera& raw) {
  if (!IsPictureSize(raw.width, raw.height)) ThrowInput(TooLargeText(raw.width, raw.height));
}

bool Distorted(const RawCamera& raw) {
  return raw.lens == Lens::kFisheye || raw.distortion != std::array<double, 5>{};
}

}  // namespace

ImagePreparation::ImagePreparation(const Calibration& calibration, Sensor sensor) try {
  CheckSize(calibration.left);
  if (calibration.right) CheckSize(*calibration.right);
  if (sensor == Sensor::kStereo && (calibration.right || Distorted(calibration.left))) {
    // Only the baseline is given: assume two equal cameras with parallel optical axes.
    const RawCamera right = calibration.right.value_or(calibration.left);
    const Se3 beside{Eigen::Matrix3d::Identity(), {calibration.baseline, 0, 0}};
    const RectifiedPair pair = RectifyStereo(calibration.left, right,
                                             calibration.right ? calibration.T_left_right : beside);
    camera_ = pair.camera;
    R_camera_rectified_ = pair.R_left_rectified;
    left_ = pair.left;
    right_ = pair.right;
  } else if (calibration.left.lens == Lens::kFisheye) {
    const RectifiedCamera one = RectifyOne(calibration.left);
    camera_ = one.camera;
    left_ = one.map;
  } else {
    camera_ = Unrectified(calibration);
    if (sensor == Sensor::kStereo) camera_.baseline = calibration.baseline;
  }
  camera_.fps = calibration.fps.value_or(kAssumedFps);
  camera_.readout_known = calibration.readout.has_value();
  if (calibration.readout) camera_.readout = *calibration.readout;
  camera_.depth_factor = sensor == Sensor::kRgbd ? calibration.depth_factor.value_or(0) : 0;
  camera_.Check();
} catch (const Error& error) {
  throw Error(error.kind(),
              (calibration.origin.empty() ? "" : calibration.origin + ": ") + error.what());
}

}  // namespace alidade
