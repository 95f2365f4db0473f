// EuRoC's sensor.yaml of one camera, given on its own.
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/euroc_calibration.h"

namespace alidade {
namespace {

bool IsEuroc(const YAML::Node& root) {
  return root["camera_model"] && root["intrinsics"] &&
         (root["sensor_type"] || root["T_BS"] || root["distortion_coefficients"]);
}

Calibration ReadEuroc(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const EurocCamera camera = EurocCameraOf(file, false);
  Calibration calibration;
  calibration.left = camera.raw;
  calibration.fps = camera.fps;
  return calibration;
}

}  // namespace

const CalibrationFormat kEurocFormat = {"EuRoC sensor.yaml", IsEuroc, ReadEuroc};

}  // namespace alidade
