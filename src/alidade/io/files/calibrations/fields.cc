#include "alidade/io/files/calibrations/fields.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/calibrations/lens_fit.h"

namespace alidade {
namespace {

constexpr double kMost = 1e9;  // as in Camera::Check()

}  // namespace

void SetIntrinsics(const YamlFile& file, const YAML::Node& at, const std::string& key,
                   const std::array<double, 4>& intrinsics, RawCamera& camera) {
  const auto& [fx, fy, cx, cy] = intrinsics;
  if (!(fx > 0 && fy > 0)) file.Fail(at, "`" + key + "`: the focal lengths must be positive");
  for (const double value : intrinsics) {
    if (!(std::abs(value) <= kMost)) file.Fail(at, "`" + key + "` has a number beyond 1e9");
  }
  if (!(fx >= 1 / kMost && fy >= 1 / kMost))
    file.Fail(at, "`" + key + "` has a focal length below 1e-9");
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
}

void SetIntrinsics(const YamlFile& file, const YAML::Node& list, const std::string& key,
                   RawCamera& camera) {
  const auto v = MatrixOf(file, list, key, 4);
  SetIntrinsics(file, list, key, {v[0], v[1], v[2], v[3]}, camera);
}

void SetMatrix(const YamlFile& file, const YAML::Node& at, const std::string& key,
               const std::vector<double>& K, RawCamera& camera) {
  SetIntrinsics(file, at, key, {K[0], K[4], K[2], K[5]}, camera);
  if (std::abs(K[1]) > 1e-6 * K[0])
    file.Fail(at, "`" + key + "` has skew (row 1, column 2), which is not supported: calibrate " +
                      "without it");
}

void SetSize(const YamlFile& file, const YAML::Node& parent, const std::string& width_key,
             const std::string& height_key, RawCamera& camera) {
  camera.width = file.PositiveInteger(file.Need(parent, width_key), width_key);
  camera.height = file.PositiveInteger(file.Need(parent, height_key), height_key);
  file.CheckSize(parent[width_key], camera.width, camera.height);
}

void SetResolution(const YamlFile& file, const YAML::Node& list, const std::string& key,
                   RawCamera& camera) {
  if (!list.IsSequence() || list.size() != 2)
    file.Fail(list, "`" + key + "` must be [width, height]");
  camera.width = file.PositiveInteger(list[0], key);
  camera.height = file.PositiveInteger(list[1], key);
  file.CheckSize(list, camera.width, camera.height);
}

void SetOpenCvLens(const YamlFile& file, const YAML::Node& at, const std::string& key,
                   const std::vector<double>& coefficients, RawCamera& camera, std::string& told) {
  RawCamera sized = camera;
  if (sized.width == 0) {
    sized.width = static_cast<int>(std::clamp(2 * sized.cx + 1, 1.0, 1e5));
    sized.height = static_cast<int>(std::clamp(2 * sized.cy + 1, 1.0, 1e5));
  }
  try {
    Tell(told, SetOpenCvLens(coefficients, sized));
  } catch (const Error& error) {
    file.Fail(at, "`" + key + "` " + error.what());
  }
  for (const double k : sized.distortion) {
    if (!(std::abs(k) <= kMost)) file.Fail(at, "`" + key + "` has a number beyond 1e9");
  }
  sized.width = camera.width;
  sized.height = camera.height;
  camera = sized;
}

void SetFisheyeLens(const YamlFile& file, const YAML::Node& at, const std::string& key,
                    const std::vector<double>& coefficients, RawCamera& camera) {
  if (std::any_of(coefficients.begin() +
                      static_cast<std::ptrdiff_t>(std::min<size_t>(4, coefficients.size())),
                  coefficients.end(), [](double k) { return k != 0; }))
    file.Fail(at, "`" + key + "` of a fisheye (equidistant) lens must be [k1, k2, k3, k4]");
  camera.lens = Lens::kFisheye;
  camera.distortion = {};
  for (size_t i = 0; i < std::min<size_t>(4, coefficients.size()); ++i) {
    if (!(std::abs(coefficients[i]) <= kMost))
      file.Fail(at, "`" + key + "` has a number beyond 1e9");
    camera.distortion[i] = coefficients[i];
  }
}

std::vector<double> MatrixOf(const YamlFile& file, const YAML::Node& node, const std::string& key,
                             size_t count) {
  auto numbers = file.Numbers(node.IsMap() ? file.Need(node, "data") : node, key);
  if (count != 0 && numbers.size() != count) {
    file.Fail(node, "`" + key + "` must have " + std::to_string(count) + " numbers, not " +
                        std::to_string(numbers.size()));
  }
  return numbers;
}

Se3 TransformOf(const YamlFile& file, const YAML::Node& node, const std::string& key) {
  auto numbers = MatrixOf(file, node, key, 0);
  if (numbers.size() == 12) numbers.insert(numbers.end(), {0, 0, 0, 1});
  if (numbers.size() != 16) file.Fail(node, "`" + key + "` must be a 4x4 (or 3x4) matrix");
  return file.Transform(node, key, numbers);
}

double NumberOr(const YamlFile& file, const YAML::Node& parent, const std::string& key,
                double missing) {
  const YAML::Node node = parent[key];
  return node && !node.IsNull() ? file.Number(node, key) : missing;
}

double PositiveNumber(const YamlFile& file, const YAML::Node& parent, const std::string& key) {
  const YAML::Node node = file.Need(parent, key);
  const double value = file.Number(node, key);
  if (!(value > 0)) file.Fail(node, "`" + key + "` must be positive, not `" + node.Scalar() + "`");
  return value;
}

void SetFps(const YamlFile& file, const YAML::Node& parent, const std::string& key,
            Calibration& calibration) {
  if (parent[key]) calibration.fps = PositiveNumber(file, parent, key);
}

void RefuseChoice(const YamlFile& file, const std::string& which) {
  if (!which.empty())
    file.Fail(file.root(), "has one camera: leave `#" + which.substr(0, 40) + "` out");
}

void Tell(std::string& told, const std::string& sentence) {
  if (sentence.empty()) return;
  if (!told.empty()) told += '\n';
  told += sentence;
}

}  // namespace alidade
