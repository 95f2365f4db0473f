// Matrices written by cv::FileStorage, under the names of OpenCV's samples and of common scripts.
#include <array>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"

namespace alidade {
namespace {

constexpr std::array kMatrixNames = {
    "camera_matrix",    "cameraMatrix", "Camera_Matrix", "CameraMatrix",
    "intrinsic_matrix", "camMatrix",    "mtx",           "K"};
constexpr std::array kDistortionNames = {"distortion_coefficients",
                                         "distortionCoefficients",
                                         "Distortion_Coefficients",
                                         "dist_coeffs",
                                         "distCoeffs",
                                         "distortion",
                                         "dist",
                                         "D"};
constexpr std::array kWidthNames = {"image_width", "image_Width", "imageWidth", "width"};
constexpr std::array kHeightNames = {"image_height", "image_Height", "imageHeight", "height"};
constexpr std::array kSizeNames = {"image_size", "imageSize", "resolution", "size"};

template <size_t kCount>
const char* FirstOf(const YAML::Node& root, const std::array<const char*, kCount>& names) {
  for (const char* name : names) {
    if (root[name] && !root[name].IsNull()) return name;
  }
  return nullptr;
}

bool IsMatrix(const YAML::Node& node) {
  return (node.IsMap() && node["data"]) || node.IsSequence();
}

bool IsPair(const YAML::Node& root) {
  return root["M1"] && root["M2"] && IsMatrix(root["M1"]) && IsMatrix(root["M2"]);
}

bool IsOpenCv(const YAML::Node& root) {
  const char* name = FirstOf(root, kMatrixNames);
  return (name && IsMatrix(root[name])) || IsPair(root);
}

void FillSize(const YamlFile& file, RawCamera& camera) {
  const YAML::Node& root = file.root();
  const char *width = FirstOf(root, kWidthNames), *height = FirstOf(root, kHeightNames);
  if (width || height) {
    SetSize(file, root, width ? width : kWidthNames[0], height ? height : kHeightNames[0], camera);
  } else if (const char* size = FirstOf(root, kSizeNames)) {
    SetResolution(file, root[size], size, camera);
  }
}

// OpenCV's calibration sample writes `fisheye_model`; others name the model.
bool IsFisheye(const YamlFile& file) {
  const YAML::Node& root = file.root();
  if (const YAML::Node flag = root["fisheye_model"])
    return flag.IsScalar() && flag.Scalar() != "0" && flag.Scalar() != "false";
  for (const char* key : {"distortion_model", "camera_model", "model"}) {
    if (!root[key]) continue;
    const std::string name = file.Text(root[key], key);
    if (name == "fisheye" || name == "equidistant" || name == "kannala_brandt") return true;
    if (name != "pinhole" && name != "perspective" && name != "opencv" && name != "radtan" &&
        name != "plumb_bob" && name != "rational_polynomial" && name != "none" && !name.empty())
      file.Fail(root[key], std::string("`") + key + "` must be pinhole or fisheye, not `" +
                               name.substr(0, 40) +
                               "`: calibrate with cv::calibrateCamera or "
                               "cv::fisheye::calibrate");
  }
  return false;
}

void FillCamera(const YamlFile& file, const std::string& matrix, const char* distortion,
                RawCamera& camera, std::string& told) {
  const YAML::Node& root = file.root();
  FillSize(file, camera);
  const YAML::Node K = file.Need(root, matrix);
  SetMatrix(file, K, matrix, MatrixOf(file, K, matrix, 9), camera);
  const bool fisheye = IsFisheye(file);
  if (!distortion || !root[distortion] || root[distortion].IsNull()) {
    if (fisheye) camera.lens = Lens::kFisheye;
    return;
  }
  const YAML::Node D = root[distortion];
  const auto k = MatrixOf(file, D, distortion, 0);
  if (fisheye) {
    SetFisheyeLens(file, D, distortion, k, camera);
  } else {
    SetOpenCvLens(file, D, distortion, k, camera, told);
  }
}

Calibration ReadOpenCv(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const YAML::Node& root = file.root();
  Calibration calibration;
  if (!IsPair(root)) {
    FillCamera(file, FirstOf(root, kMatrixNames), FirstOf(root, kDistortionNames), calibration.left,
               calibration.told);
    return calibration;
  }
  // cv::stereoCalibrate(): p_right = R p_left + T, in the unit of the target's squares.
  FillCamera(file, "M1", "D1", calibration.left, calibration.told);
  if (!root["R"] || !root["T"]) return calibration;
  RawCamera right;
  FillCamera(file, "M2", "D2", right, calibration.told);
  const auto R = MatrixOf(file, root["R"], "R", 9), T = MatrixOf(file, root["T"], "T", 3);
  const double length = std::hypot(T[0], T[1], T[2]);
  if (!(length > 0 && length < 10)) {
    file.Fail(root["T"], "`T` must be in meters, not " + std::to_string(length) +
                             " long: divide it by 1000 if the target's squares were given in "
                             "millimeters");
  }
  calibration.T_left_right = file.Transform(root["R"], "R",
                                            {R[0], R[1], R[2], T[0], R[3], R[4], R[5], T[1], R[6],
                                             R[7], R[8], T[2], 0, 0, 0, 1})
                                 .Inverse();
  calibration.right = right;
  return calibration;
}

}  // namespace

const CalibrationFormat kOpenCvFormat = {"OpenCV", IsOpenCv, ReadOpenCv};

}  // namespace alidade
