#include "alidade/io/files/euroc_calibration.h"

#include <algorithm>

#include "alidade/io/files/file.h"

namespace alidade {
namespace {

std::vector<double> ListOf(const YamlFile& file, const char* key, size_t least, size_t most) {
  const YAML::Node node = file.Need(file.root(), key);
  auto numbers = file.Numbers(node, key);
  if (numbers.size() < least || numbers.size() > most) {
    file.Fail(node,
              std::string("`") + key + "` has " + std::to_string(numbers.size()) + " numbers");
  }
  return numbers;
}

Lens LensOf(const YamlFile& file) {
  const YAML::Node model = file.Need(file.root(), "camera_model");
  if (file.Text(model, "camera_model") != "pinhole") {
    file.Fail(model,
              "only the camera_model `pinhole` is known, not `" + model.Scalar() +
                  "`: calibrate as pinhole, wide lenses with the distortion_model equidistant");
  }
  const YAML::Node node = file.root()["distortion_model"];
  const std::string name = node ? file.Text(node, "distortion_model") : "none";
  if (name == "equidistant" || name == "equi") return Lens::kFisheye;
  if (name != "radial-tangential" && name != "radtan" && name != "plumb_bob" && name != "none") {
    file.Fail(node, "distortion_model is radial-tangential or equidistant, not `" + name + "`");
  }
  return Lens::kPinhole;
}

}  // namespace

EurocCamera ReadEurocCamera(const std::string& path) {
  return ParseEurocCamera(ReadFile(path, kMostConfigBytes), path);
}

EurocCamera ParseEurocCamera(const std::string& text, const std::string& name) {
  return EurocCameraOf(YamlFile(text, name), true);
}

EurocCamera EurocCameraOf(const YamlFile& file, bool need_pose) {
  EurocCamera camera;
  camera.raw.lens = LensOf(file);
  const YAML::Node resolution = file.Need(file.root(), "resolution");
  if (!resolution.IsSequence() || resolution.size() != 2)
    file.Fail(resolution, "`resolution` must be [width, height]");
  camera.raw.width = file.PositiveInteger(resolution[0], "resolution");
  camera.raw.height = file.PositiveInteger(resolution[1], "resolution");
  file.CheckSize(resolution, camera.raw.width, camera.raw.height);
  const auto intrinsics = ListOf(file, "intrinsics", 4, 4);
  camera.raw.fx = intrinsics[0];
  camera.raw.fy = intrinsics[1];
  camera.raw.cx = intrinsics[2];
  camera.raw.cy = intrinsics[3];
  if (!(camera.raw.fx > 0 && camera.raw.fy > 0)) {
    file.Fail(file.root()["intrinsics"], "the focal lengths in `intrinsics` must be positive");
  }
  if (file.root()["distortion_coefficients"]) {
    const auto k =
        ListOf(file, "distortion_coefficients", 0, camera.raw.lens == Lens::kFisheye ? 4 : 5);
    std::copy(k.begin(), k.end(), camera.raw.distortion.begin());
  }
  if (const YAML::Node rate = file.root()["rate_hz"]) {
    camera.fps = file.Number(rate, "rate_hz");
    if (!(*camera.fps > 0)) file.Fail(rate, "`rate_hz` must be positive");
  }
  if (!need_pose && !file.root()["T_BS"]) return camera;
  const YAML::Node T_BS = file.Need(file.root(), "T_BS");
  // EuRoC writes {rows, cols, data: [...]}; a plain list of 16 numbers is accepted as well.
  camera.T_body_camera = file.Transform(T_BS.IsMap() ? file.Need(T_BS, "data") : T_BS, "T_BS");
  return camera;
}

}  // namespace alidade
