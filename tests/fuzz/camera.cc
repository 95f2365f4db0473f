#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "fuzz/targets.h"
#include "fuzz/use_calibration.h"

namespace alidade::fuzz {

void CameraFile(std::string_view bytes) {
  Calibration calibration = ParseCameraFile(std::string(bytes), "camera.yaml");
  if (calibration.left.width == 0) calibration = FitToSize(std::move(calibration), {20, 16});
  UseCalibration(std::move(calibration));
}

}  // namespace alidade::fuzz
