// Configuration of stella_vslam (`Camera:` with fx, fy, …) and OpenVSLAM (`Camera.fx`).
#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/ros/camera_info.h"

namespace alidade {
namespace {

bool IsStella(const YAML::Node& root) {
  const YAML::Node camera = root["Camera"];
  if (camera && camera.IsMap()) return camera["model"] || camera["setup"] || camera["fx"];
  return root["Camera.model"] || root["Camera.setup"];
}

// A map and the prefix of its keys: stella_vslam has maps, OpenVSLAM dots.
struct Section {
  YAML::Node map;
  std::string prefix;
  YAML::Node operator[](const char* key) const { return map[prefix + key]; }
};

Section SectionOf(const YAML::Node& root, const std::string& name) {
  const YAML::Node map = root[name];
  if (map && map.IsMap()) return {map, ""};
  return {root, name + "."};
}

// Raw cameras of a pair, with rotations; the rectified camera is that of `Camera`.
CameraInfo InfoOf(const YamlFile& file, const Section& section, const std::string& side,
                  const RawCamera& rectified, double baseline) {
  CameraInfo info;
  info.width = static_cast<uint32_t>(rectified.width);
  info.height = static_cast<uint32_t>(rectified.height);
  const auto need = [&](const char* name) { return section.prefix + name + side; };
  const auto fill = [&](const char* name, auto& matrix) {
    const auto numbers =
        MatrixOf(file, file.Need(section.map, need(name)), need(name), matrix.size());
    std::copy(numbers.begin(), numbers.end(), matrix.begin());
  };
  fill("K_", info.K);
  fill("R_", info.R);
  info.D = MatrixOf(file, file.Need(section.map, need("D_")), need("D_"), 0);
  if (const YAML::Node model = section["model"]) {
    const std::string name = file.Text(model, "model");
    if (name != "perspective" && name != "fisheye")
      file.Fail(model, "StereoRectifier's `model` must be perspective or fisheye, not `" +
                           name.substr(0, 40) + "`: calibrate the pair as one of these");
    if (name == "fisheye") info.distortion_model = "fisheye";
  }
  RawCamera checked;
  SetMatrix(file, section.map[need("K_")], need("K_"), {info.K.begin(), info.K.end()}, checked);
  info.P = {rectified.fx,
            0,
            rectified.cx,
            -rectified.fx * baseline,
            0,
            rectified.fy,
            rectified.cy,
            0,
            0,
            0,
            1,
            0};
  return info;
}

void FillPair(const YamlFile& file, const Section& pair, Calibration& calibration) {
  const RawCamera rectified = calibration.left;
  const CameraInfo left = InfoOf(file, pair, "left", rectified, 0);
  const CameraInfo right = InfoOf(file, pair, "right", rectified, calibration.baseline);
  const std::string at = pair.prefix + "D_left";
  calibration.baseline = 0;
  try {
    calibration.left = *CameraOfInfo(left, false, &calibration.told);
    if (!AddRightCamera(left, right, false, calibration))
      ThrowInput("need `focal_x_baseline` of `Camera`");
  } catch (const Error& error) {
    file.Fail(pair.map[at], "StereoRectifier's cameras: " + std::string(error.what()));
  }
}

void FillLens(const YamlFile& file, const Section& section, Calibration& calibration) {
  const YAML::Node model = section["model"];
  const std::string model_key = section.prefix + "model";
  const std::string name = model ? file.Text(model, model_key) : "perspective";
  const auto coefficient = [&](const char* key) {
    return NumberOr(file, section.map, section.prefix + key, 0);
  };
  const std::string first = section.prefix + "k1";
  const YAML::Node at = section["k1"] ? section["k1"] : section["fx"];
  if (name == "perspective") {
    SetOpenCvLens(file, at, first,
                  {coefficient("k1"), coefficient("k2"), coefficient("p1"), coefficient("p2"),
                   coefficient("k3")},
                  calibration.left, calibration.told);
  } else if (name == "fisheye") {
    SetFisheyeLens(file, at, first,
                   {coefficient("k1"), coefficient("k2"), coefficient("k3"), coefficient("k4")},
                   calibration.left);
  } else {
    file.Fail(model,
              "`" + model_key + "` must be perspective or fisheye, not `" + name.substr(0, 40) +
                  "`: " +
                  (name == "equirectangular" ? "cut perspective images out of the panorama first"
                                             : "calibrate the camera as one of these"));
  }
}

Calibration ReadStella(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const YAML::Node& root = file.root();
  const Section section = SectionOf(root, "Camera");
  const std::string& prefix = section.prefix;
  Calibration calibration;
  if (section["model"] && section["model"].IsScalar() &&
      section["model"].Scalar() == "equirectangular")
    FillLens(file, section, calibration);  // refuses it: there are no focal lengths
  if (section["cols"] || section["rows"])
    SetSize(file, section.map, prefix + "cols", prefix + "rows", calibration.left);
  const auto number = [&](const char* key) {
    return file.Number(file.Need(section.map, prefix + key), prefix + key);
  };
  SetIntrinsics(file, section["fx"], prefix + "fx",
                {number("fx"), number("fy"), number("cx"), number("cy")}, calibration.left);
  FillLens(file, section, calibration);
  SetFps(file, section.map, prefix + "fps", calibration);
  for (const char* place : {"Camera", "Preprocessing", "Tracking"}) {
    const Section of = SectionOf(root, place);
    const std::string key = of.prefix + "depthmap_factor";
    if (of.map[key]) calibration.depth_factor = PositiveNumber(file, of.map, key);
  }
  if (root["depthmap_factor"])
    calibration.depth_factor = PositiveNumber(file, root, "depthmap_factor");
  const std::string setup = section["setup"] ? file.Text(section["setup"], prefix + "setup") : "";
  if (setup == "stereo" && section["focal_x_baseline"]) {  // of a depth camera it is virtual
    calibration.baseline =
        PositiveNumber(file, section.map, prefix + "focal_x_baseline") / calibration.left.fx;
    const Section pair = SectionOf(root, "StereoRectifier");
    if (pair["K_left"]) FillPair(file, pair, calibration);
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kStellaFormat = {"stella_vslam configuration", IsStella, ReadStella};

}  // namespace alidade
