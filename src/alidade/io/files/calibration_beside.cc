#include "alidade/io/files/calibration_beside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/files/depth_size.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

constexpr char kOwnName[] = "camera.yaml";

constexpr std::array kNames = {"camera_info.yaml", "camera_info.yml", "ost.yaml",
                               "sensor.yaml",      "transforms.json", "cameras.txt",
                               "calibration.yaml", "calibration.yml", "calibration.json",
                               "calibration.xml",  "calib.yaml",      "calib.yml",
                               "calib.json",       "camera.yml",      "camera.json",
                               "intrinsics.yaml",  "intrinsics.json"};

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// Kalibr writes camchain-NAME.yaml, newer versions NAME-camchain.yaml; camchain-imucam if
// calibrated with an IMU.
bool IsCamchain(std::string_view name) {
  return (EndsWith(name, ".yaml") || EndsWith(name, ".yml")) &&
         (name.rfind("camchain", 0) == 0 || name.find("-camchain") != std::string_view::npos);
}

bool IsKnownName(const std::string& name) {
  return std::any_of(kNames.begin(), kNames.end(), [&](const char* n) { return name == n; }) ||
         IsCamchain(name);
}

// Largest distance of two cameras' pixels of one direction, for directions across the image.
double Difference(const RawCamera& a, const RawCamera& b) {
  constexpr int kCells = 8;
  double largest = 0;
  for (int row = 0; row <= kCells; ++row) {
    for (int column = 0; column <= kCells; ++column) {
      const Eigen::Vector2d pixel((a.width - 1.0) * column / kCells,
                                  (a.height - 1.0) * row / kCells);
      const Eigen::Vector3d direction = a.Direction(pixel);
      if (!(direction.z() > 0)) continue;
      const double distance = (a.Project(direction) - b.Project(direction)).norm();
      if (!std::isfinite(distance)) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, distance);
    }
  }
  return largest;
}

// How much more than one camera's intrinsics a calibration states.
int Completeness(const Calibration& calibration) {
  return 8 * (calibration.right || calibration.baseline > 0 ? 1 : 0) +
         4 * (calibration.depth_factor ? 1 : 0) + 2 * (calibration.readout ? 1 : 0) +
         (calibration.fps ? 1 : 0);
}

// The calibration of another tool, for images of `size`; nullopt, with a warning, if it cannot be
// used.
std::optional<Calibration> ReadOther(const std::string& file, cv::Size size) {
  try {
    return FitToSize(ReadCameraFile(file, size), size, /*with_right=*/false);
  } catch (const Error& error) {
    LogWarning(std::string("a calibration found beside the recording is not used: ") +
               error.what());
    return std::nullopt;
  }
}

[[noreturn]] void RefuseSeveral(const std::vector<Calibration>& found, double difference) {
  std::string names;
  for (const Calibration& one : found) names += (names.empty() ? "" : ", ") + one.origin;
  char by[40];
  PrintTo(by, sizeof by, std::isfinite(difference) ? "%.3g pixels" : "more than the image",
          difference);
  ThrowInput("the calibrations beside the recording disagree by " + std::string(by) + ": " + names +
             ". Choose one: --camera " + found.front().origin);
}

}  // namespace

std::vector<std::string> CalibrationFilesIn(const std::string& folder) {
  const std::string place = folder.empty() ? "." : folder;
  const auto path = [&](const std::string& name) {
    return folder.empty() || folder.back() == '/' ? folder + name : folder + "/" + name;
  };
  if (IsThere(path(kOwnName))) return {path(kOwnName)};
  std::vector<std::string> files;
  try {
    for (const std::string& name : NamesIn(place)) {
      if (IsKnownName(name) && IsFile(path(name))) files.push_back(path(name));
    }
  } catch (const Error&) {  // a folder that may be entered but not listed
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::optional<Calibration> CalibrationBeside(const std::string& folder, cv::Size size,
                                             const SourceOptions& options) {
  const std::vector<std::string> files = CalibrationFilesIn(folder);
  if (files.empty()) return std::nullopt;
  if (EndsWith(files.front(), kOwnName)) return ReadCameraFile(files.front(), size);
  if (options.camera_file || options.fov_degrees) return std::nullopt;
  std::vector<Calibration> found;
  for (const std::string& file : files) {
    if (auto calibration = ReadOther(file, size)) found.push_back(std::move(*calibration));
  }
  if (found.empty()) return std::nullopt;
  double difference = 0;
  for (const Calibration& one : found)
    difference = std::max(difference, Difference(found.front().left, one.left));
  if (difference > kSameCalibration) RefuseSeveral(found, difference);
  const auto best = std::max_element(
      found.begin(), found.end(),
      [](const Calibration& a, const Calibration& b) { return Completeness(a) < Completeness(b); });
  best->told = "calibration found beside the recording: " + best->origin +
               (best->told.empty() ? "" : "\n" + best->told);
  return *best;
}

}  // namespace alidade
