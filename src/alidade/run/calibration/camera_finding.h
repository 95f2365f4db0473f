// What is known of a run's camera, and how it came to be.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "alidade/calibration/lens_check.h"
#include "alidade/run/calibration/find_camera.h"

namespace alidade {

struct CameraFinding {
  Camera camera;  // of the recording's images (stereo, fisheye: as rectified)
  // given (--camera, --fov), file (beside the recording, or the loaded map's), estimated (found
  // from the recording itself), assumed (66 degrees, or found but not for certain).
  std::string known = "file";
  double focal_sigma = 0;            // standard deviation of the focal length, relative; 0: exact
  std::optional<CameraFound> found;  // when it was looked for
  double cpu_s = 0, wall_s = 0;      // of that search, seconds
  // Of its rolling shutter at the end (see Camera); sigma 0: given, or not estimated.
  std::array<double, 2> readout{};
  double readout_sigma = 0;
  LensCheck lens;  // at the end
};

}  // namespace alidade
