// ROS: the files of camera_calibration (camera_info_manager), and CameraInfo as `rostopic echo` and
// `ros2 topic echo` print it.
#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/ros/camera_info.h"

namespace alidade {
namespace {

// Field of a file and of a message in ROS 1 and 2.
struct Names {
  const char *file, *ros1, *ros2;
};
constexpr Names kWidth = {"image_width", "width", "width"};
constexpr Names kHeight = {"image_height", "height", "height"};
constexpr Names kK = {"camera_matrix", "K", "k"};
constexpr Names kD = {"distortion_coefficients", "D", "d"};
constexpr Names kR = {"rectification_matrix", "R", "r"};
constexpr Names kP = {"projection_matrix", "P", "p"};

const char* NameIn(const YAML::Node& root, const Names& names) {
  for (const char* name : {names.file, names.ros1, names.ros2}) {
    if (root[name]) return name;
  }
  return names.file;
}

bool IsRos(const YAML::Node& root) {
  if (root["camera_matrix"])
    return root["camera_name"] || root["distortion_model"] || root["projection_matrix"] ||
           root["rectification_matrix"];
  const YAML::Node K = root["K"] ? root["K"] : root["k"];
  return K && K.IsSequence() && (root["distortion_model"] || root["D"] || root["d"]);
}

uint32_t Whole(const YamlFile& file, const YAML::Node& parent, const char* key) {
  const YAML::Node node = parent[key];
  if (!node || node.IsNull()) return 0;
  const double number = file.Number(node, key);
  if (!(number >= 0 && number <= 100000) || number != static_cast<int>(number))
    file.Fail(node, "`" + std::string(key) + "` must be a whole number from 0 to 100000");
  return static_cast<uint32_t>(number);
}

template <size_t kCount>
void Fill(const YamlFile& file, const Names& names, std::array<double, kCount>& matrix) {
  const std::string name = NameIn(file.root(), names);
  const YAML::Node node = file.root()[name];
  if (!node || node.IsNull()) return;
  const auto numbers = MatrixOf(file, node, name, kCount);
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
}

Calibration ReadRos(const YamlFile& file, const std::string& which) {
  RefuseChoice(file, which);
  const YAML::Node& root = file.root();
  CameraInfo info;
  Calibration calibration;
  RawCamera size;
  SetSize(file, root, NameIn(root, kWidth), NameIn(root, kHeight), size);
  info.width = static_cast<uint32_t>(size.width);
  info.height = static_cast<uint32_t>(size.height);
  const std::string K = NameIn(root, kK), D = NameIn(root, kD);
  const YAML::Node matrix = file.Need(root, K);
  Fill(file, kK, info.K);
  Fill(file, kR, info.R);
  Fill(file, kP, info.P);
  SetMatrix(file, matrix, K, {info.K.begin(), info.K.end()}, calibration.left);
  if (root[D] && !root[D].IsNull()) info.D = MatrixOf(file, root[D], D, 0);
  if (const YAML::Node model = root["distortion_model"])
    info.distortion_model = file.Text(model, "distortion_model");
  info.binning_x = Whole(file, root, "binning_x");
  info.binning_y = Whole(file, root, "binning_y");
  if (const YAML::Node roi = root["roi"]; roi && roi.IsMap()) {
    info.roi_x = Whole(file, roi, "x_offset");
    info.roi_y = Whole(file, roi, "y_offset");
    info.roi_width = Whole(file, roi, "width");
    info.roi_height = Whole(file, roi, "height");
  }
  try {
    const auto camera = CameraOfInfo(info, false, &calibration.told);
    if (!camera) file.Fail(matrix, "`" + K + "` is 0: the camera was not calibrated");
    calibration.left = *camera;
  } catch (const Error& error) {
    file.Fail(root[D] ? root[D] : matrix, error.what());
  }
  // Of the right camera of a pair: P(0, 3) = -fx × baseline. It is of the rectified images: those
  // of a lens that needs no rectification only.
  if (info.P[0] > 0 && info.P[3] != 0) {
    const double baseline = -info.P[3] / info.P[0];
    const bool rectified = calibration.left.distortion == std::array<double, 5>{} &&
                           (info.R == std::array<double, 9>{} ||
                            info.R == std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
    if (!rectified) {
      Tell(calibration.told,
           file.path() +
               ": the baseline in `P` is not used, since the images are not "
               "rectified: for stereo give both cameras, as in a Kalibr camchain");
    } else if (baseline > 0 && baseline < 100) {
      calibration.baseline = baseline;
    } else {
      Tell(calibration.told, file.path() + ": the baseline in `P`, " + std::to_string(baseline) +
                                 " m, is not used: for stereo give the file of the right camera");
    }
  }
  return calibration;
}

}  // namespace

const CalibrationFormat kRosFormat = {"ROS camera_info", IsRos, ReadRos};

}  // namespace alidade
