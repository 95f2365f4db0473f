// Settings of ORB-SLAM 2 and 3: `Camera.fx` (old) or `Camera1.fx` (File.version 1.0).
#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/ros/camera_info.h"

namespace alidade {
namespace {

bool IsOrbSlam(const YAML::Node& root) {
  if (root["Camera.model"] || root["Camera.setup"]) return false;  // OpenVSLAM
  return root["Camera.fx"] || root["Camera1.fx"] || root["Camera.type"] || root["LEFT.K"];
}

// kPinhole for `Rectified` as well.
Lens OrbSlamLens(const YamlFile& file) {
  const YAML::Node type = file.root()["Camera.type"];
  if (!type) return Lens::kPinhole;
  const std::string name = file.Text(type, "Camera.type");
  if (name == "KannalaBrandt8") return Lens::kFisheye;
  if (name != "PinHole" && name != "Rectified")
    file.Fail(type, "`Camera.type` must be PinHole, KannalaBrandt8 or Rectified, not `" +
                        name.substr(0, 40) + "`: correct it");
  return Lens::kPinhole;
}

RawCamera ReadCamera(const YamlFile& file, const std::string& prefix, Lens lens,
                     std::string& told) {
  const YAML::Node& root = file.root();
  RawCamera camera;
  if (root["Camera.width"] || root["Camera.height"])
    SetSize(file, root, "Camera.width", "Camera.height", camera);
  const auto number = [&](const char* key) {
    return file.Number(file.Need(root, prefix + key), prefix + key);
  };
  SetIntrinsics(file, root[prefix + "fx"], prefix + "fx",
                {number("fx"), number("fy"), number("cx"), number("cy")}, camera);
  const auto coefficient = [&](const char* key) { return NumberOr(file, root, prefix + key, 0); };
  const std::string first = prefix + "k1";
  const YAML::Node at = root[first] ? root[first] : root[prefix + "fx"];
  if (lens == Lens::kFisheye) {
    SetFisheyeLens(file, at, first,
                   {coefficient("k1"), coefficient("k2"), coefficient("k3"), coefficient("k4")},
                   camera);
  } else if (!root["Camera.type"] || root["Camera.type"].Scalar() != "Rectified") {
    SetOpenCvLens(file, at, first,
                  {coefficient("k1"), coefficient("k2"), coefficient("p1"), coefficient("p2"),
                   coefficient("k3")},
                  camera, told);
  }
  return camera;
}

// The old settings of a pair that is rectified by the program: raw cameras, rotations and
// projections, as in ROS's CameraInfo.
CameraInfo InfoOf(const YamlFile& file, const std::string& side) {
  const YAML::Node& root = file.root();
  CameraInfo info;
  RawCamera camera;
  SetSize(file, root, side + "width", side + "height", camera);
  info.width = static_cast<uint32_t>(camera.width);
  info.height = static_cast<uint32_t>(camera.height);
  const auto fill = [&](const char* name, auto& matrix) {
    const auto numbers = MatrixOf(file, file.Need(root, side + name), side + name, matrix.size());
    std::copy(numbers.begin(), numbers.end(), matrix.begin());
  };
  fill("K", info.K);
  fill("R", info.R);
  fill("P", info.P);
  SetMatrix(file, root[side + "K"], side + "K", {info.K.begin(), info.K.end()}, camera);
  info.D = MatrixOf(file, file.Need(root, side + "D"), side + "D", 0);
  return info;
}

void FillPair(const YamlFile& file, Calibration& calibration) {
  const CameraInfo left = InfoOf(file, "LEFT."), right = InfoOf(file, "RIGHT.");
  try {
    const auto camera = CameraOfInfo(left, false, &calibration.told);
    if (camera) calibration.left = *camera;
    if (!camera || !AddRightCamera(left, right, false, calibration))
      file.Fail(file.root()["RIGHT.P"], "`RIGHT.P` must contain -fx × baseline in row 1, column 4");
  } catch (const Error& error) {
    if (std::string(error.what()).rfind(file.path(), 0) == 0) throw;
    file.Fail(file.root()["LEFT.D"], std::string("`LEFT.D` or `RIGHT.D` ") + error.what());
  }
}

Calibration ReadOrbSlam(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const YAML::Node& root = file.root();
  Calibration calibration;
  const Lens lens = OrbSlamLens(file);
  const bool modern = root["Camera1.fx"].IsDefined();
  SetFps(file, root, "Camera.fps", calibration);
  for (const char* key : {"RGBD.DepthMapFactor", "DepthMapFactor"}) {
    if (root[key]) calibration.depth_factor = PositiveNumber(file, root, key);
  }
  if (root["LEFT.K"] && root["RIGHT.K"]) {
    FillPair(file, calibration);
    return calibration;
  }
  const std::string prefix = modern ? "Camera1." : "Camera.";
  calibration.left = ReadCamera(file, prefix, lens, calibration.told);
  const char* pose = root["Stereo.T_c1_c2"] ? "Stereo.T_c1_c2" : "Tlr";
  if (root["Camera2.fx"] && root[pose]) {
    calibration.right = ReadCamera(file, "Camera2.", lens, calibration.told);
    calibration.T_left_right = TransformOf(file, root[pose], pose);
  } else if (!calibration.depth_factor) {  // that of a depth camera is not a second camera's
    if (root["Stereo.b"]) {
      calibration.baseline = PositiveNumber(file, root, "Stereo.b");
    } else if (root["Camera.bf"]) {
      calibration.baseline = PositiveNumber(file, root, "Camera.bf") / calibration.left.fx;
    }
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kOrbSlamFormat = {"ORB-SLAM settings", IsOrbSlam, ReadOrbSlam};

}  // namespace alidade
