#include "alidade/io/files/camera_file.h"
#include "fuzz/targets.h"
#include "fuzz/use_calibration.h"

namespace alidade::fuzz {

void CameraFile(std::string_view bytes) {
  UseCalibration(ParseCameraFile(std::string(bytes), "camera.yaml"));
}

}  // namespace alidade::fuzz
