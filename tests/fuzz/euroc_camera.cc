#include "alidade/io/files/euroc_calibration.h"
#include "fuzz/targets.h"
#include "fuzz/use_calibration.h"

namespace alidade::fuzz {

// Uses the camera as a pair with the same camera 0.1 m to its right.
void EurocCamera(std::string_view bytes) {
  const alidade::EurocCamera camera = ParseEurocCamera(std::string(bytes), "sensor.yaml");
  Expect(camera.T_body_camera.R.allFinite() && camera.T_body_camera.t.allFinite(),
         "the camera is nowhere on the body");
  Calibration calibration;
  calibration.left = camera.raw;
  calibration.fps = camera.fps;
  calibration.right = camera.raw;
  calibration.T_left_right.t = {0.1, 0, 0};
  UseCalibration(calibration);
}

}  // namespace alidade::fuzz
