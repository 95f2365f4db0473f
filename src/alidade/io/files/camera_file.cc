#include "alidade/io/files/camera_file.h"

#include <algorithm>
#include <array>

#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/io/files/file.h"
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
  static constexpr std::array kLeftOnly = {"fps", "readout", "depth_factor", "baseline", "right"};
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

}  // namespace

Calibration ReadCameraFile(const std::string& path) {
  return ParseCameraFile(ReadFile(path, kMostConfigBytes), path);
}

Calibration ParseCameraFile(const std::string& text, const std::string& name) {
  const YamlFile file(text, name);
  const YAML::Node& root = file.root();
  WarnOfUnknownKeys(file, root, false);
  Calibration calibration;
  calibration.origin = name;
  calibration.left = ReadRawCamera(file, root);
  if (root["fps"]) calibration.fps = Positive(file, root, "fps");
  if (const YAML::Node readout = root["readout"]) calibration.readout = ReadReadout(file, readout);
  if (const YAML::Node factor = root["depth_factor"]) {
    calibration.depth_factor = file.Number(factor, "depth_factor");
    if (*calibration.depth_factor < 0) file.Fail(factor, "`depth_factor` must not be negative");
  }
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

std::string FormatCameraFile(const Camera& camera, const std::string& comment) {
  std::string text;
  for (size_t begin = 0; begin < comment.size();) {
    const size_t end = std::min(comment.find('\n', begin), comment.size());
    text += "# " + comment.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  const auto exact = [](double value) {
    char digits[40];
    PrintTo(digits, sizeof(digits), "%.17g", value);
    return std::string(digits);
  };
  text += "model: pinhole\nwidth: " + std::to_string(camera.width) +
          "\nheight: " + std::to_string(camera.height) + "\nfx: " + exact(camera.fx) +
          "\nfy: " + exact(camera.fy) + "\ncx: " + exact(camera.cx) + "\ncy: " + exact(camera.cy) +
          "\ndistortion: [";
  for (size_t i = 0; i < camera.distortion.size(); ++i)
    text += (i > 0 ? ", " : "") + exact(camera.distortion[i]);
  text += "]\nfps: " + exact(camera.fps) + "\n";
  if (camera.readout[0] != 0) {
    text += "readout: [" + exact(camera.readout[0]) + ", " + exact(camera.readout[1]) + "]\n";
  } else if (camera.readout_known || camera.readout[1] != 0) {
    text += "readout: " + exact(camera.readout[1]) + "\n";
  }
  if (camera.depth_factor > 0) text += "depth_factor: " + exact(camera.depth_factor) + "\n";
  if (camera.baseline > 0) text += "baseline: " + exact(camera.baseline) + "\n";
  return text;
}

Calibration GuessedCalibration(int width, int height, double fov_degrees) {
  const Camera camera = Camera::FromFieldOfView(width, height, fov_degrees);
  Calibration calibration;
  calibration.left = {Lens::kPinhole, width,     height,    camera.fx,
                      camera.fy,      camera.cx, camera.cy, {}};
  return calibration;
}

}  // namespace alidade
