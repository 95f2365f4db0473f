// Basalt's calibration JSON: `value0` with intrinsics, T_imu_cam and resolution of all cameras.
#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/calibrations/radial_models.h"

namespace alidade {
namespace {

constexpr char kBasaltAdvice[] = "calibrate again with `--cam-types kb4` (or pinhole)";

bool IsBasalt(const YAML::Node& root) {
  const YAML::Node value = root["value0"];
  return value && value.IsMap() && value["intrinsics"] && value["intrinsics"].IsSequence();
}

RawCamera ReadBasaltCamera(const YamlFile& file, const YAML::Node& node,
                           const YAML::Node& resolution, std::string& told) {
  RawCamera camera;
  SetResolution(file, resolution, "resolution", camera);
  const YAML::Node model = file.Need(node, "camera_type");
  const std::string name = file.Text(model, "camera_type");
  const YAML::Node values = file.Need(node, "intrinsics");
  if (!values.IsMap()) file.Fail(values, "`intrinsics` must have fx, fy, cx, cy, …");
  const auto number = [&](const char* key) { return file.Number(file.Need(values, key), key); };
  const std::array<double, 4> intrinsics = {number("fx"), number("fy"), number("cx"), number("cy")};
  SetIntrinsics(file, values, "intrinsics", intrinsics, camera);
  if (name == "pinhole") return camera;
  if (name == "kb4") {
    SetFisheyeLens(file, values, "intrinsics",
                   {number("k1"), number("k2"), number("k3"), number("k4")}, camera);
  } else if (name == "pinhole-radtan8") {
    SetOpenCvLens(file, values, "intrinsics",
                  {number("k1"), number("k2"), number("p1"), number("p2"), number("k3"),
                   number("k4"), number("k5"), number("k6")},
                  camera, told);
  } else {
    std::vector<double> parameters(intrinsics.begin(), intrinsics.end());
    for (const char* key : {"xi", "alpha", "beta", "w"}) {
      if (values[key]) parameters.push_back(number(key));
    }
    SetRadialModel(file, model, "camera_type", name, values, "intrinsics", parameters,
                   kBasaltAdvice, camera, told);
  }
  return camera;
}

Se3 PoseOf(const YamlFile& file, const YAML::Node& node) {
  const auto number = [&](const char* key) { return file.Number(file.Need(node, key), key); };
  const Eigen::Quaterniond q(number("qw"), number("qx"), number("qy"), number("qz"));
  if (!(std::abs(q.norm() - 1) < 1e-2))
    file.Fail(node, "`T_imu_cam`: qx, qy, qz, qw are not a unit quaternion");
  return Se3::FromQuaternion(q, {number("px"), number("py"), number("pz")});
}

Calibration ReadBasalt(const YamlFile& file, const std::string& which) {
  const YAML::Node value = file.root()["value0"];
  const YAML::Node cameras = value["intrinsics"], sizes = file.Need(value, "resolution");
  const size_t count = cameras.size();
  if (count == 0 || !sizes.IsSequence() || sizes.size() != count)
    file.Fail(sizes, "`resolution` must have [width, height] for each camera in `intrinsics`");
  size_t chosen = 0;
  if (!which.empty()) {
    while (chosen < count && std::to_string(chosen) != which) ++chosen;
    if (chosen == count)
      file.Fail(cameras, "there is no camera `" + which + "`: choose one of 0 to " +
                             std::to_string(count - 1));
  }
  Calibration calibration;
  calibration.left = ReadBasaltCamera(file, cameras[chosen], sizes[chosen], calibration.told);
  const YAML::Node poses = value["T_imu_cam"];
  if (!which.empty() || count < 2 || !poses || !poses.IsSequence() || poses.size() != count)
    return calibration;
  calibration.right = ReadBasaltCamera(file, cameras[1], sizes[1], calibration.told);
  calibration.T_left_right = PoseOf(file, poses[0]).Inverse() * PoseOf(file, poses[1]);
  return calibration;
}

}  // namespace

const CalibrationFormat kBasaltFormat = {"Basalt calibration", IsBasalt, ReadBasalt};

}  // namespace alidade
