// transforms.json of nerfstudio and instant-ngp (docs.nerf.studio, "Data conventions"). The pixel
// origin is the image's corner: half a pixel is subtracted.
#include <array>
#include <cmath>

#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"

namespace alidade {
namespace {

bool HasFrames(const YAML::Node& root) {
  const YAML::Node frames = root["frames"];
  return frames && frames.IsSequence() && frames.size() > 0 && frames[0].IsMap();
}

bool IsNerfstudio(const YAML::Node& root) {
  return root["fl_x"] || root["camera_angle_x"] ||
         (HasFrames(root) && (root["frames"][0]["fl_x"] || root["frames"][0]["file_path"]));
}

// The intrinsics may be those of each frame.
YAML::Node HolderOf(const YamlFile& file) {
  const YAML::Node& root = file.root();
  if (root["fl_x"] || root["camera_angle_x"] || !HasFrames(root)) return root;
  const YAML::Node first = root["frames"][0];
  static constexpr std::array kKeys = {"fl_x", "fl_y", "cx", "cy", "w",  "h",
                                       "k1",   "k2",   "k3", "k4", "p1", "p2"};
  for (const YAML::Node& frame : root["frames"]) {
    for (const char* key : kKeys) {
      const auto text = [&](const YAML::Node& node) {
        return node.IsMap() && node[key] && node[key].IsScalar() ? node[key].Scalar() : "";
      };
      if (text(frame) != text(first)) {
        file.Fail(frame, std::string("frames have different `") + key +
                             "`: one camera for all frames is needed");
      }
    }
  }
  return first;
}

Calibration ReadNerfstudio(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const YAML::Node& root = file.root();
  const YAML::Node holder = HolderOf(file);
  Calibration calibration;
  RawCamera& camera = calibration.left;
  if (holder["w"] || holder["h"]) SetSize(file, holder, "w", "h", camera);
  double fx = 0;
  std::string focal_key = "fl_x";
  if (!holder["fl_x"] && holder["camera_angle_x"]) {  // NeRF's synthetic scenes
    focal_key = "camera_angle_x";
    const double angle = PositiveNumber(file, holder, focal_key);
    if (camera.width == 0)
      file.Fail(holder[focal_key],
                "`camera_angle_x` without `w` and `h`: give the field of view with --fov, in "
                "degrees, instead of this file");
    fx = camera.width / (2 * std::tan(angle / 2));
  } else {
    fx = PositiveNumber(file, holder, "fl_x");
  }
  const double fy = holder["fl_y"] ? PositiveNumber(file, holder, "fl_y") : fx;
  if (camera.width == 0 && !(holder["cx"] && holder["cy"]))
    file.Fail(holder, "`cx` and `cy`, or `w` and `h`, are missing");
  SetIntrinsics(file, holder[focal_key], focal_key,
                {fx, fy, NumberOr(file, holder, "cx", camera.width / 2.0) - 0.5,
                 NumberOr(file, holder, "cy", camera.height / 2.0) - 0.5},
                camera);
  const YAML::Node model = root["camera_model"] ? root["camera_model"] : holder["camera_model"];
  const std::string name = model ? file.Text(model, "camera_model") : "OPENCV";
  const auto number = [&](const char* key) { return NumberOr(file, holder, key, 0); };
  const YAML::Node at = holder["k1"] ? holder["k1"] : holder[focal_key];
  if (name == "OPENCV_FISHEYE") {
    SetFisheyeLens(file, at, "k1", {number("k1"), number("k2"), number("k3"), number("k4")},
                   camera);
  } else if (name == "OPENCV" || name == "PINHOLE" || name == "SIMPLE_PINHOLE" ||
             name == "SIMPLE_RADIAL" || name == "RADIAL" || name == "PERSPECTIVE") {
    if (number("k4") != 0)
      file.Fail(holder["k4"], "`k4` of the camera_model " + name +
                                  " is not supported: calibrate with k1 k2 k3 p1 p2 only");
    SetOpenCvLens(file, at, "k1",
                  {number("k1"), number("k2"), number("p1"), number("p2"), number("k3")}, camera,
                  calibration.told);
  } else {
    file.Fail(model, "`camera_model` must be OPENCV, OPENCV_FISHEYE or PINHOLE, not `" +
                         name.substr(0, 40) + "`: make perspective images of it first");
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kNerfstudioFormat = {"nerfstudio transforms.json", IsNerfstudio,
                                             ReadNerfstudio};

}  // namespace alidade
