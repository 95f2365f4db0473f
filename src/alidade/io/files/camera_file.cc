#include "alidade/io/files/camera_file.h"

#include <algorithm>
#include <array>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/calibrations/calibration_text.h"
#include "alidade/io/files/calibrations/fold.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/calibrations/write_calibration.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/imu_file.h"
#include "alidade/io/files/yaml.h"

namespace alidade {
namespace {

double Positive(const YamlFile& file, const YAML::Node& parent, const char* key) {
  const YAML::Node node = file.Need(parent, key);
  const double value = file.Number(node, key);
  if (!(value > 0))
    file.Fail(node, std::string("`") + key + "` must be positive, not `" + node.Scalar() + "`");
  return value;
}

// Warns of unknown keys, which may be misspelled: `distorsion` must not silently mean no
// distortion.
void WarnOfUnknownKeys(const YamlFile& file, const YAML::Node& parent, bool right) {
  static constexpr std::array kCommon = {"model", "width", "height", "fx",
                                         "fy",    "cx",    "cy",     "distortion"};
  static constexpr std::array kLeftOnly = {"fps",      "readout", "depth_factor",
                                           "baseline", "right",   "imu"};
  for (const auto& entry : parent) {
    const std::string key = entry.first.Scalar();
    const auto is_key = [&key](const char* known) { return key == known; };
    const bool known =
        std::any_of(kCommon.begin(), kCommon.end(), is_key) ||
        (right ? key == "T_left_right" : std::any_of(kLeftOnly.begin(), kLeftOnly.end(), is_key));
    if (!known) {
      LogWarning(file.path() + ":" + std::to_string(entry.first.Mark().line + 1) + ": `" + key +
                 "` is not known here");
    }
  }
}

RawCamera ReadRawCamera(const YamlFile& file, const YAML::Node& node) {
  RawCamera raw;
  const YAML::Node model = file.Need(node, "model");
  const std::string name = file.Text(model, "model");
  if (name != "pinhole" && name != "fisheye")
    file.Fail(model, "`model` must be pinhole or fisheye, not `" + name + "`");
  raw.lens = name == "pinhole" ? Lens::kPinhole : Lens::kFisheye;
  raw.width = file.PositiveInteger(file.Need(node, "width"), "width");
  raw.height = file.PositiveInteger(file.Need(node, "height"), "height");
  file.CheckSize(node["width"], raw.width, raw.height);
  raw.fx = Positive(file, node, "fx");
  raw.fy = Positive(file, node, "fy");
  raw.cx = file.Number(file.Need(node, "cx"), "cx");
  raw.cy = file.Number(file.Need(node, "cy"), "cy");
  if (const YAML::Node distortion = node["distortion"]) {
    const auto k = file.Numbers(distortion, "distortion");
    const size_t most = raw.lens == Lens::kPinhole ? 5 : 4;
    if (k.size() > most || (k.size() != 4 && k.size() != 5 && !k.empty())) {
      file.Fail(distortion, raw.lens == Lens::kPinhole
                                ? "`distortion` must be [k1, k2, p1, p2, k3] (k3 is optional)"
                                : "`distortion` of a fisheye camera must be [k1, k2, k3, k4]");
    }
    std::copy(k.begin(), k.end(), raw.distortion.begin());
  }
  return raw;
}

// One number: time from the top row to the bottom row. Two numbers: [left to right, top to bottom].
// Seconds.
std::array<double, 2> ReadReadout(const YamlFile& file, const YAML::Node& node) {
  if (!node.IsSequence()) return {0, file.Number(node, "readout")};
  const auto both = file.Numbers(node, "readout");
  if (both.size() != 2)
    file.Fail(node, "`readout` must be one number (seconds from the top to the bottom row) or two");
  return {both[0], both[1]};
}

// Alidade's own format.
Calibration ReadOwn(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const YAML::Node& root = file.root();
  WarnOfUnknownKeys(file, root, false);
  Calibration calibration;
  calibration.left = ReadRawCamera(file, root);
  if (root["fps"]) calibration.fps = Positive(file, root, "fps");
  if (const YAML::Node readout = root["readout"]) calibration.readout = ReadReadout(file, readout);
  if (const YAML::Node factor = root["depth_factor"]) {
    calibration.depth_factor = file.Number(factor, "depth_factor");
    if (*calibration.depth_factor < 0) file.Fail(factor, "`depth_factor` must not be negative");
  }
  if (root["imu"]) ImuModelOf(file, root["imu"]);  // ReadImuModel() reads it where it is needed
  if (const YAML::Node right = root["right"]) {
    if (root["baseline"]) file.Fail(root["baseline"], "give either `baseline` or `right`");
    if (!right.IsMap()) file.Fail(right, "`right` must contain the names and values of a camera");
    WarnOfUnknownKeys(file, right, true);
    calibration.right = ReadRawCamera(file, right);
    calibration.T_left_right = file.Transform(file.Need(right, "T_left_right"), "T_left_right");
  } else if (root["baseline"]) {
    calibration.baseline = Positive(file, root, "baseline");
  }
  return calibration;
}

// With a single of these names the file is meant to be Alidade's, so that a mistake in it is named.
bool IsOwn(const YAML::Node& root) {
  static constexpr std::array kNames = {"model", "width", "height", "fx", "fy", "cx", "cy"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](const char* name) { return root[name].IsDefined(); });
}

// Asked in this order; Alidade's own names are the least specific.
constexpr std::array kFormats = {
    &kKalibrFormat,     &kEurocFormat,     &kRosFormat, &kOrbSlamFormat, &kStellaFormat,
    &kNerfstudioFormat, &kRealSenseFormat, &kOakFormat, &kBasaltFormat,  &kOpenCvFormat};

std::string KnownFormats() {
  std::string names = "camera.yaml of Alidade, COLMAP cameras.txt";
  for (const CalibrationFormat* format : kFormats) names += std::string(", ") + format->name;
  return names;
}

Calibration ReadYaml(const YamlFile& text, const std::string& which) {
  YamlFile file = text;
  for (const CalibrationFormat* format : kFormats) {
    if (!format->recognizes(file.root())) continue;
    file.SetTool(format->name);
    return format->reads(file, which);
  }
  if (IsOwn(file.root())) return ReadOwn(file, which);
  ThrowInput(file.path() + ": is not a calibration that is known here; known are " +
             KnownFormats());
}

}  // namespace

std::string CameraFilePath(const std::string& given) {
  const size_t mark = given.rfind('#');
  return mark == std::string::npos || mark == 0 || IsThere(given) ? given : given.substr(0, mark);
}

Calibration ReadCameraFile(const std::string& given, cv::Size images) {
  const std::string path = CameraFilePath(given);
  const std::string which = path.size() < given.size() ? given.substr(path.size() + 1) : "";
  return ParseCameraFile(ReadFile(path, kMostCalibrationBytes), path, which, images);
}

Calibration ParseCameraFile(const std::string& text, const std::string& name,
                            const std::string& which, cv::Size images) {
  Calibration calibration;
  try {
    calibration = IsColmapCameras(text) ? ReadColmapCameras(text, name, which)
                  : IsRealSenseListing(text)
                      ? ReadYaml(YamlFile(YamlOfListing(text, name, which, images), name), {})
                      : ReadYaml(YamlOfCalibration(text, name), which);
  } catch (const YAML::Exception& error) {  // a value where a map is expected, and similar
    ThrowInput(name + (error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1)) +
               ": " + error.msg);
  }
  calibration.origin = name;
  return calibration;
}

void RefuseFolds(const Calibration& calibration, bool with_right) {
  for (const RawCamera* camera :
       {&calibration.left, with_right && calibration.right ? &*calibration.right : nullptr}) {
    if (!camera || camera->width == 0) continue;
    const std::optional<double> radius = FoldRadius(*camera);
    if (!radius) continue;
    ThrowInput((calibration.origin.empty() ? "the calibration" : calibration.origin) + ": the " +
               (camera == &calibration.left ? "" : "right camera's ") +
               "distortion folds inside the image: from " +
               std::to_string(static_cast<int>(std::min(*radius, 1e9))) +
               " pixels off the principal point on, two directions share a pixel. Calibrate again, "
               "with the target also at the borders of the image or with fewer coefficients, or "
               "crop the images");
  }
}

void RequireSize(const Calibration& calibration, bool with_right) {
  if (calibration.left.width == 0 ||
      (with_right && calibration.right && calibration.right->width == 0))
    ThrowInput(calibration.origin +
               ": the width and height of the images are missing: add them to the file");
  RefuseFolds(calibration, with_right);
}

Calibration CalibrationOf(const Camera& camera) {
  Calibration calibration;
  calibration.left = {Lens::kPinhole, camera.width, camera.height, camera.fx,
                      camera.fy,      camera.cx,    camera.cy,     camera.distortion};
  calibration.baseline = camera.baseline;
  calibration.fps = camera.fps;
  if (camera.readout_known || camera.RollingShutter()) calibration.readout = camera.readout;
  if (camera.depth_factor > 0) calibration.depth_factor = camera.depth_factor;
  return calibration;
}

std::string FormatCameraFile(const Camera& camera, const std::string& comment) {
  return FormatCalibration(CalibrationOf(camera), CalibrationStyle::kAlidade, comment).text;
}

Calibration GuessedCalibration(int width, int height, double fov_degrees) {
  const Camera camera = Camera::FromFieldOfView(width, height, fov_degrees);
  Calibration calibration;
  calibration.left = {Lens::kPinhole, width,     height,    camera.fx,
                      camera.fy,      camera.cx, camera.cy, {}};
  return calibration;
}

}  // namespace alidade
