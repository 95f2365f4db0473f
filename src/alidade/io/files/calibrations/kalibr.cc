// Kalibr's camchain.yaml (github.com/ethz-asl/kalibr/wiki/yaml-formats).
#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/calibrations/radial_models.h"

namespace alidade {
namespace {

bool IsKalibrCamera(const YAML::Node& node) {
  return node.IsMap() && node["camera_model"] && node["intrinsics"];
}

bool IsKalibr(const YAML::Node& root) {
  for (const auto& entry : root) {
    const std::string& key = entry.first.Scalar();
    if (key.size() > 3 && key.compare(0, 3, "cam") == 0 &&
        key.find_first_not_of("0123456789", 3) == std::string::npos && entry.second.IsMap() &&
        (entry.second["camera_model"] || entry.second["intrinsics"]))
      return true;
  }
  // a camera of a chain on its own
  return IsKalibrCamera(root) && root["distortion_coeffs"];
}

RawCamera ReadKalibrCamera(const YamlFile& file, const YAML::Node& node, std::string& told) {
  RawCamera camera;
  SetResolution(file, file.Need(node, "resolution"), "resolution", camera);
  const YAML::Node model = file.Need(node, "camera_model");
  const std::string name = file.Text(model, "camera_model");
  const YAML::Node intrinsics = file.Need(node, "intrinsics");
  const auto values = MatrixOf(file, intrinsics, "intrinsics", 0);
  const YAML::Node coeffs = node["distortion_coeffs"];
  const auto k = coeffs && !coeffs.IsNull() ? MatrixOf(file, coeffs, "distortion_coeffs", 0)
                                            : std::vector<double>();
  const std::string lens =
      node["distortion_model"] ? file.Text(node["distortion_model"], "distortion_model") : "none";
  if (name != "pinhole") {
    const bool bent = std::any_of(k.begin(), k.end(), [](double value) { return value != 0; });
    if (bent && lens != "none") {
      file.Fail(model, "camera_model `" + name + "` with distortion_model `" + lens +
                           "` is not supported: calibrate again with `--models pinhole-equi` (or "
                           "pinhole-radtan below 90 degrees)");
    }
    // Kalibr has the shape parameters first: [xi, alpha, fx, fy, cx, cy].
    auto ordered = values;
    if (ordered.size() > 4) std::rotate(ordered.begin(), ordered.end() - 4, ordered.end());
    SetRadialModel(file, model, "camera_model", name, intrinsics, "intrinsics", ordered,
                   "calibrate again with `--models pinhole-equi`", camera, told);
    return camera;
  }
  SetIntrinsics(file, intrinsics, "intrinsics", camera);
  if (lens == "radtan") {
    if (k.size() != 4)
      file.Fail(coeffs ? coeffs : node, "`distortion_coeffs` of radtan must be [k1, k2, p1, p2]");
    SetOpenCvLens(file, coeffs, "distortion_coeffs", k, camera, told);
  } else if (lens == "equi" || lens == "equidistant") {
    if (k.size() != 4)
      file.Fail(coeffs ? coeffs : node, "`distortion_coeffs` of equi must be [k1, k2, k3, k4]");
    SetFisheyeLens(file, coeffs, "distortion_coeffs", k, camera);
  } else if (lens == "fov") {
    if (k.size() != 1) file.Fail(coeffs ? coeffs : node, "`distortion_coeffs` of fov must be [w]");
    SetRadialModel(file, node["distortion_model"], "distortion_model", "fov", coeffs,
                   "distortion_coeffs", {camera.fx, camera.fy, camera.cx, camera.cy, k[0]},
                   "calibrate again with `--models pinhole-equi`", camera, told);
  } else if (lens != "none") {
    file.Fail(node["distortion_model"],
              "distortion_model `" + lens +
                  "` is not supported: calibrate again with `--models pinhole-radtan` or, for wide "
                  "lenses, pinhole-equi");
  }
  return camera;
}

// Pose of camera 0 in camera 1, if the file states it: T_cn_cnm1, or both poses of the IMU.
std::optional<Se3> PoseInRight(const YamlFile& file, const YAML::Node& left,
                               const YAML::Node& right) {
  if (right["T_cn_cnm1"]) return TransformOf(file, right["T_cn_cnm1"], "T_cn_cnm1");
  const auto of_imu = [&](const YAML::Node& node) -> std::optional<Se3> {
    if (node["T_cam_imu"]) return TransformOf(file, node["T_cam_imu"], "T_cam_imu");
    if (node["T_imu_cam"]) return TransformOf(file, node["T_imu_cam"], "T_imu_cam").Inverse();
    return std::nullopt;
  };
  const auto T_left_imu = of_imu(left), T_right_imu = of_imu(right);
  if (!T_left_imu || !T_right_imu) return std::nullopt;
  return *T_right_imu * T_left_imu->Inverse();
}

Calibration ReadKalibr(const YamlFile& file, const std::string& which) {
  const YAML::Node& root = file.root();
  Calibration calibration;
  if (IsKalibrCamera(root)) {
    RefuseChoice(file, which);
    calibration.left = ReadKalibrCamera(file, root, calibration.told);
    return calibration;
  }
  const YAML::Node left = file.Need(root, which.empty() ? "cam0" : which);
  if (!left.IsMap()) file.Fail(left, "`" + (which.empty() ? "cam0" : which) + "` must be a camera");
  calibration.left = ReadKalibrCamera(file, left, calibration.told);
  const YAML::Node right = root["cam1"];
  if (!which.empty() || !right || !right.IsMap()) return calibration;
  try {
    const auto T_right_left = PoseInRight(file, left, right);
    if (!T_right_left) return calibration;
    std::string told;
    calibration.right = ReadKalibrCamera(file, right, told);
    calibration.T_left_right = T_right_left->Inverse();
    if (!told.empty()) Tell(calibration.told, told);
  } catch (const Error& error) {  // the first camera can still be used on its own
    LogWarning(std::string(error.what()) + "; only cam0 is used");
    calibration.right.reset();
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kKalibrFormat = {"Kalibr camchain", IsKalibr, ReadKalibr};

}  // namespace alidade
