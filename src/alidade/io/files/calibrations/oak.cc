// OAK cameras: the calibration that DepthAI's CalibrationHandler writes as JSON. Matrices are for
// the sensor's full size, lengths in centimeters.
#include <map>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"

namespace alidade {
namespace {

constexpr double kMetersPerUnit = 0.01;

bool IsOak(const YAML::Node& root) { return root["cameraData"].IsDefined(); }

// `cameraData` is a list of [socket, camera], or a map.
std::map<std::string, YAML::Node> CamerasOf(const YamlFile& file) {
  const YAML::Node data = file.Need(file.root(), "cameraData");
  std::map<std::string, YAML::Node> cameras;
  const auto add = [&](const YAML::Node& socket, const YAML::Node& camera) {
    if (!camera.IsMap()) file.Fail(camera, "`cameraData` must contain [socket, camera] pairs");
    cameras.emplace(file.Text(socket, "cameraData"), camera);
  };
  if (data.IsMap()) {
    for (const auto& entry : data) add(entry.first, entry.second);
  } else if (data.IsSequence()) {
    for (const YAML::Node& entry : data) {
      if (!entry.IsSequence() || entry.size() != 2)
        file.Fail(entry, "`cameraData` must contain [socket, camera] pairs");
      add(entry[0], entry[1]);
    }
  }
  if (cameras.empty()) file.Fail(data, "`cameraData` contains no camera");
  return cameras;
}

RawCamera ReadOakCamera(const YamlFile& file, const YAML::Node& node, std::string& told) {
  RawCamera camera;
  SetSize(file, node, "width", "height", camera);
  const YAML::Node matrix = file.Need(node, "intrinsicMatrix");
  SetMatrix(file, matrix, "intrinsicMatrix", MatrixOf(file, matrix, "intrinsicMatrix", 9), camera);
  const YAML::Node coeffs = node["distortionCoeff"];
  const auto k = coeffs && !coeffs.IsNull() ? MatrixOf(file, coeffs, "distortionCoeff", 0)
                                            : std::vector<double>();
  const YAML::Node type = node["cameraType"];
  const std::string name = type ? file.Text(type, "cameraType") : "0";
  if (name == "0" || name == "Perspective") {
    if (!k.empty()) SetOpenCvLens(file, coeffs, "distortionCoeff", k, camera, told);
  } else if (name == "1" || name == "Fisheye") {
    SetFisheyeLens(file, coeffs ? coeffs : node, "distortionCoeff", k, camera);
  } else {
    file.Fail(type, "`cameraType` must be 0 (perspective) or 1 (fisheye), not `" +
                        name.substr(0, 40) + "`: calibrate as one of these");
  }
  return camera;
}

// Pose of the camera in the one that its `extrinsics` refer to; nullopt: none.
std::optional<Se3> PoseInOther(const YamlFile& file, const YAML::Node& node, std::string& other) {
  const YAML::Node extrinsics = node["extrinsics"];
  if (!extrinsics || !extrinsics.IsMap() || !extrinsics["toCameraSocket"]) return std::nullopt;
  other = file.Text(extrinsics["toCameraSocket"], "toCameraSocket");
  if (other == "-1" || other == "AUTO") return std::nullopt;
  const YAML::Node rotation = file.Need(extrinsics, "rotationMatrix");
  const YAML::Node translation = file.Need(extrinsics, "translation");
  const auto R = MatrixOf(file, rotation, "rotationMatrix", 0);
  if (R.empty()) return std::nullopt;
  if (R.size() != 9) file.Fail(rotation, "`rotationMatrix` must have 9 numbers");
  const auto t = [&](const char* key) {
    return kMetersPerUnit * file.Number(file.Need(translation, key), key);
  };
  return file.Transform(
      rotation, "rotationMatrix",
      {R[0], R[1], R[2], t("x"), R[3], R[4], R[5], t("y"), R[6], R[7], R[8], t("z"), 0, 0, 0, 1});
}

Calibration ReadOak(const YamlFile& file, const std::string& which) {
  const auto cameras = CamerasOf(file);
  std::string names;
  for (const auto& [socket, camera] : cameras) names += (names.empty() ? "" : ", ") + socket;
  auto chosen = cameras.find(which);
  if (which.empty() && cameras.size() == 1) chosen = cameras.begin();
  if (chosen == cameras.end()) {
    const std::string example = cameras.begin()->first;
    file.Fail(
        file.root()["cameraData"],
        (which.empty() ? "has the camera sockets " + names +
                             " (0 or CAM_A: color, 1 or CAM_B: left with the right one, 2 or "
                             "CAM_C: right): choose"
                       : "there is no camera socket `" + which + "`, only " + names + ": choose") +
            " one, for instance --camera " + file.path() + "#" + example);
  }
  Calibration calibration;
  calibration.left = ReadOakCamera(file, chosen->second, calibration.told);
  std::string other;
  const auto T_other_this = PoseInOther(file, chosen->second, other);
  if (!T_other_this || cameras.count(other) == 0) return calibration;
  const Se3 T_this_other = T_other_this->Inverse();
  // Only a camera to the right makes a stereo pair.
  if (T_this_other.t.x() > 0.5 * T_this_other.t.norm()) {
    const RawCamera right = ReadOakCamera(file, cameras.at(other), calibration.told);
    if (right.width == calibration.left.width && right.height == calibration.left.height) {
      calibration.right = right;
      calibration.T_left_right = T_this_other;
    }
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kOakFormat = {"OAK (DepthAI) calibration", IsOak, ReadOak};

}  // namespace alidade
