// Intel RealSense: the fields of rs2_intrinsics (width, height, ppx, ppy, fx, fy, model, coeffs) as
// scripts with pyrealsense2 write them, for one stream or in a map of streams.
#include <algorithm>
#include <cctype>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/calibrations/lens_fit.h"

namespace alidade {
namespace {

bool IsIntrinsics(const YAML::Node& node) { return node.IsMap() && node["ppx"] && node["ppy"]; }

bool IsRealSense(const YAML::Node& root) {
  if (IsIntrinsics(root)) return true;
  return std::any_of(root.begin(), root.end(),
                     [](const auto& entry) { return IsIntrinsics(entry.second); });
}

// "distortion.inverse_brown_conrady", "RS2_DISTORTION_BROWN_CONRADY", "Inverse Brown Conrady" and
// rs2_distortion's number, all as "inverse_brown_conrady".
std::string ModelName(const YamlFile& file, const YAML::Node& node) {
  static constexpr std::array kNumbered = {
      "none",   "modified_brown_conrady", "inverse_brown_conrady",
      "ftheta", "brown_conrady",          "kannala_brandt4"};
  std::string name = file.Text(node, "model").substr(0, 60);
  for (char& c : name) {
    c = c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (const std::string start : {"distortion.", "rs2_distortion_"}) {
    if (name.rfind(start, 0) == 0) name = name.substr(start.size());
  }
  if (name.size() == 1 && name[0] >= '0' && name[0] < '6')
    return kNumbered[static_cast<size_t>(name[0] - '0')];
  return name;
}

// The inverse model maps distorted to ideal positions by Brown's formula.
LensSamples SampleInverse(const RawCamera& camera, const std::vector<double>& k) {
  RawCamera inverse = camera;
  std::copy_n(k.begin(), 5, inverse.distortion.begin());
  LensSamples out;
  constexpr int kCells = 40;
  for (int row = 0; row <= kCells; ++row) {
    for (int column = 0; column <= kCells; ++column) {
      const double x = ((camera.width - 1.0) * column / kCells - camera.cx) / camera.fx;
      const double y = ((camera.height - 1.0) * row / kCells - camera.cy) / camera.fy;
      const Eigen::Vector2d ideal = inverse.Project({x, y, 1});
      const Eigen::Vector3d p((ideal.x() - camera.cx) / camera.fx,
                              (ideal.y() - camera.cy) / camera.fy, 1);
      out.samples.push_back({p.normalized(), {x, y}});
    }
  }
  return out;
}

void FillLens(const YamlFile& file, const YAML::Node& node, RawCamera& camera, std::string& told) {
  const YAML::Node coeffs = node["coeffs"];
  auto k = coeffs && !coeffs.IsNull() ? MatrixOf(file, coeffs, "coeffs", 0) : std::vector<double>();
  if (k.size() > 5)
    file.Fail(coeffs, "`coeffs` must have 5 numbers, not " + std::to_string(k.size()));
  k.resize(5);
  const YAML::Node model = node["model"];
  const std::string name = model ? ModelName(file, model) : "none";
  const bool bent = std::any_of(k.begin(), k.end(), [](double value) { return value != 0; });
  if (name == "kannala_brandt4") {
    SetFisheyeLens(file, coeffs ? coeffs : node, "coeffs", {k.begin(), k.begin() + 4}, camera);
  } else if (!bent) {
    return;
  } else if (name == "brown_conrady" ||
             (name == "modified_brown_conrady" && k[2] == 0 && k[3] == 0)) {
    SetOpenCvLens(file, coeffs, "coeffs", k, camera, told);
  } else if (name == "inverse_brown_conrady") {
    try {
      Tell(told, ApproximateLens("inverse Brown-Conrady", SampleInverse(camera, k), camera));
    } catch (const Error& error) {
      file.Fail(model, std::string("`model` ") + error.what());
    }
  } else {
    file.Fail(
        model ? model : node,
        "`model` must be none, brown_conrady, inverse_brown_conrady or kannala_brandt4, not `" +
            name.substr(0, 40) +
            "`, because `coeffs` are not 0: record another stream, or calibrate "
            "with a target");
  }
}

Calibration ReadRealSense(const YamlFile& file, const std::string& which) {
  YAML::Node node = file.root();
  if (!IsIntrinsics(node)) {
    std::string names, first, chosen = which;
    int streams = 0;
    for (const auto& entry : node) {
      if (!IsIntrinsics(entry.second)) continue;
      if (++streams == 1) first = entry.first.Scalar();
      names += (names.empty() ? "" : ", ") + entry.first.Scalar().substr(0, 40);
    }
    if (chosen.empty() && streams == 1) chosen = first;
    if (chosen.empty())
      file.Fail(node, "has the streams " + names + ": choose one, for instance --camera " +
                          file.path() + "#" + first);
    if (!node[chosen] || !IsIntrinsics(node[chosen]))
      file.Fail(node, "there is no stream `" + chosen + "`, only " + names);
    node.reset(node[chosen]);  // an assignment would change the document
  } else {
    RefuseChoice(file, which);
  }
  Calibration calibration;
  SetSize(file, node, "width", "height", calibration.left);
  const auto number = [&](const char* key) { return file.Number(file.Need(node, key), key); };
  SetIntrinsics(file, file.Need(node, "fx"), "fx",
                {number("fx"), number("fy"), number("ppx"), number("ppy")}, calibration.left);
  FillLens(file, node, calibration.left, calibration.told);
  for (const YAML::Node& place : {node, file.root()}) {  // meters of one unit of the depth images
    if (place["depth_scale"])
      calibration.depth_factor = 1 / PositiveNumber(file, place, "depth_scale");
    SetFps(file, place, "fps", calibration);
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kRealSenseFormat = {"RealSense intrinsics", IsRealSense, ReadRealSense};

}  // namespace alidade
