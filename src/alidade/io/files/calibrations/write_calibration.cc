#include "alidade/io/files/calibrations/write_calibration.h"

#include <array>
#include <span>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/colmap.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/lens_fit.h"

namespace alidade {
namespace {

struct Style {
  CalibrationStyle style;
  const char *name, *file;
};
constexpr std::array<Style, 5> kStyles = {{{CalibrationStyle::kAlidade, "alidade", "camera.yaml"},
                                           {CalibrationStyle::kKalibr, "kalibr", "camchain.yaml"},
                                           {CalibrationStyle::kRos, "ros", "camera_info.yaml"},
                                           {CalibrationStyle::kOpenCv, "opencv", "opencv.yaml"},
                                           {CalibrationStyle::kColmap, "colmap", "cameras.txt"}}};
constexpr char kOpenCvStart[] = "%YAML:1.0\n---\n";

std::string Exact(double value) {
  char digits[40];
  PrintTo(digits, sizeof digits, "%.17g", value);
  return digits;
}

std::string Joined(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + Exact(value);
  return text;
}

std::string Commented(const std::string& comment) {
  std::string text;
  for (size_t begin = 0; begin < comment.size();) {
    const size_t end = std::min(comment.find('\n', begin), comment.size());
    text += "# " + comment.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return text;
}

bool IsFisheye(const RawCamera& camera) { return camera.lens == Lens::kFisheye; }

std::span<const double> Coefficients(const RawCamera& camera) {
  return std::span(camera.distortion).first(IsFisheye(camera) ? 4 : 5);
}

std::vector<double> Matrix(const RawCamera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

std::vector<double> Matrix(const Se3& T) {
  std::vector<double> values;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) values.push_back(T.R(row, column));
    values.push_back(T.t[row]);
  }
  values.insert(values.end(), {0, 0, 0, 1});
  return values;
}

// Second camera of a pair; of an already rectified one it equals the first.
std::optional<RawCamera> RightOf(const Calibration& calibration) {
  if (calibration.right || !(calibration.baseline > 0)) return calibration.right;
  return calibration.left;
}
Se3 RightPose(const Calibration& calibration) {
  if (calibration.right) return calibration.T_left_right;
  return {Eigen::Matrix3d::Identity(), {calibration.baseline, 0, 0}};
}

std::string OwnCamera(const RawCamera& camera, const std::string& indent) {
  const auto line = [&](const std::string& key, const std::string& value) {
    return indent + key + ": " + value + "\n";
  };
  return line("model", IsFisheye(camera) ? "fisheye" : "pinhole") +
         line("width", std::to_string(camera.width)) +
         line("height", std::to_string(camera.height)) + line("fx", Exact(camera.fx)) +
         line("fy", Exact(camera.fy)) + line("cx", Exact(camera.cx)) +
         line("cy", Exact(camera.cy)) +
         line("distortion", "[" + Joined(Coefficients(camera)) + "]");
}

std::string OwnText(const Calibration& c) {
  std::string text = OwnCamera(c.left, "");
  if (c.fps) text += "fps: " + Exact(*c.fps) + "\n";
  if (c.readout && (*c.readout)[0] == 0) {
    text += "readout: " + Exact((*c.readout)[1]) + "\n";
  } else if (c.readout) {
    text += "readout: [" + Joined(*c.readout) + "]\n";
  }
  if (c.depth_factor) text += "depth_factor: " + Exact(*c.depth_factor) + "\n";
  if (c.right) {
    text += "right:\n" + OwnCamera(*c.right, "  ") + "  T_left_right: [" +
            Joined(Matrix(c.T_left_right)) + "]\n";
  } else if (c.baseline > 0) {
    text += "baseline: " + Exact(c.baseline) + "\n";
  }
  return text;
}

// The block `imu` of camera.yaml: what is known.
std::string OwnImu(const ImuModel& imu) {
  std::string text = "imu:\n";
  if (imu.rate > 0) text += "  rate: " + Exact(imu.rate) + "\n";
  if (imu.rotation_known && imu.translation_known) {
    text += "  T_camera_imu: [" + Joined(Matrix(imu.T_camera_imu)) + "]\n";
  } else if (imu.rotation_known) {
    std::vector<double> R;
    for (int i = 0; i < 9; ++i) R.push_back(imu.T_camera_imu.R(i / 3, i % 3));
    text += "  R_camera_imu: [" + Joined(R) + "]\n";
  }
  if (imu.time_offset_known) text += "  time_offset: " + Exact(imu.time_offset) + "\n";
  return text + "  gyro_noise: " + Exact(imu.noise.gyro) +
         "\n  accel_noise: " + Exact(imu.noise.accel) +
         "\n  gyro_walk: " + Exact(imu.noise.gyro_walk) +
         "\n  accel_walk: " + Exact(imu.noise.accel_walk) + "\n";
}

// Kalibr's radtan has four coefficients: k3 is approximated by the others.
RawCamera WithoutK3(const RawCamera& camera, std::string& told) {
  if (IsFisheye(camera) || camera.distortion[4] == 0) return camera;
  const auto samples =
      SampleLens(camera, [&](const Eigen::Vector3d& p) -> std::optional<Eigen::Vector2d> {
        if (!(p.z() > 1e-2)) return std::nullopt;
        const Eigen::Vector2d pixel = camera.Project(p);
        return Eigen::Vector2d((pixel.x() - camera.cx) / camera.fx,
                               (pixel.y() - camera.cy) / camera.fy);
      });
  if (!samples.Enough()) {
    ThrowUsage(
        "Kalibr's radtan has no k3, and it cannot be approximated: the principal point is too far "
        "outside the image; write ros or opencv instead");
  }
  const LensFit fit = FitBrown(camera, samples.samples, 4);
  char error[40];
  PrintTo(error, sizeof error, "%.2g pixels", fit.error);
  if (!samples.whole || !(fit.error <= kMostMisfit)) {
    ThrowUsage(
        std::string("Kalibr's radtan has no k3, and without it the distortion would be wrong by ") +
        error + ": write ros or opencv instead");
  }
  Tell(told, std::string("Kalibr's radtan has no k3; largest error in the image: ") + error);
  return fit.camera;
}

std::string KalibrRows(const std::string& key, const Se3& T) {
  std::string text = "  " + key + ":\n";
  const auto values = Matrix(T);
  for (size_t row = 0; row < 4; ++row)
    text += "  - [" + Joined(std::span(values).subspan(4 * row, 4)) + "]\n";
  return text;
}

std::string KalibrCamera(const RawCamera& given, int number, const Se3* T_this_before,
                         std::string& told) {
  const RawCamera camera = WithoutK3(given, told);
  const std::string name = "cam" + std::to_string(number);
  std::string text = name + ":\n";
  if (T_this_before) text += KalibrRows("T_cn_cnm1", *T_this_before);
  text += "  camera_model: pinhole\n  distortion_coeffs: [" +
          Joined(std::span(camera.distortion).first(4)) +
          "]\n  distortion_model: " + (IsFisheye(camera) ? "equi" : "radtan") +
          "\n  intrinsics: [" + Joined(std::array{camera.fx, camera.fy, camera.cx, camera.cy}) +
          "]\n  resolution: [" + std::to_string(camera.width) + ", " +
          std::to_string(camera.height) + "]\n  rostopic: /" + name + "/image_raw\n";
  return text;
}

// camchain-imucam.yaml where the sensor's rotation is known: t_imu = t_cam + timeshift_cam_imu.
std::string KalibrText(const Calibration& c, const std::optional<ImuModel>& imu,
                       std::string& told) {
  std::string text = KalibrCamera(c.left, 0, nullptr, told);
  if (imu && imu->rotation_known) {
    text += KalibrRows("T_cam_imu", imu->T_camera_imu) +
            "  timeshift_cam_imu: " + Exact(imu->time_offset) + "\n";
    if (!imu->translation_known)
      Tell(told, "the place of the inertial sensor is not known: T_cam_imu has zeros");
  }
  if (const auto right = RightOf(c)) {
    const Se3 T_right_left = RightPose(c).Inverse();
    text += KalibrCamera(*right, 1, &T_right_left, told);
  }
  return text;
}

std::string RosMatrix(const std::string& name, int rows, int columns,
                      std::span<const double> values) {
  return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
         "\n  data: [" + Joined(values) + "]\n";
}

std::string RosText(const RawCamera& camera) {
  const auto K = Matrix(camera);
  const std::array<double, 9> R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 12> P = {camera.fx, 0, camera.cx, 0, 0, camera.fy,
                                    camera.cy, 0, 0,         0, 1, 0};
  const auto D = Coefficients(camera);
  return "image_width: " + std::to_string(camera.width) +
         "\nimage_height: " + std::to_string(camera.height) + "\ncamera_name: camera\n" +
         RosMatrix("camera_matrix", 3, 3, K) +
         "distortion_model: " + (IsFisheye(camera) ? "equidistant" : "plumb_bob") + "\n" +
         RosMatrix("distortion_coefficients", 1, static_cast<int>(D.size()), D) +
         RosMatrix("rectification_matrix", 3, 3, R) + RosMatrix("projection_matrix", 3, 4, P);
}

std::string OpenCvMatrix(const std::string& name, int rows, int columns,
                         std::span<const double> values) {
  return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [ " + Joined(values) +
         " ]\n";
}

std::string OpenCvText(const Calibration& c) {
  const auto camera = [](const RawCamera& one, const std::string& matrix,
                         const std::string& distortion) {
    const auto D = Coefficients(one);
    return OpenCvMatrix(matrix, 3, 3, Matrix(one)) +
           OpenCvMatrix(distortion, static_cast<int>(D.size()), 1, D);
  };
  std::string text = "image_width: " + std::to_string(c.left.width) +
                     "\nimage_height: " + std::to_string(c.left.height) +
                     "\nfisheye_model: " + (IsFisheye(c.left) ? "1\n" : "0\n");
  const auto right = RightOf(c);
  if (!right) return text + camera(c.left, "camera_matrix", "distortion_coefficients");
  if (right->lens != c.left.lens)
    ThrowUsage("OpenCV's files have one lens model for both cameras: write kalibr instead");
  const Se3 T_right_left = RightPose(c).Inverse();
  std::vector<double> R;
  for (int i = 0; i < 9; ++i) R.push_back(T_right_left.R(i / 3, i % 3));
  return text + camera(c.left, "M1", "D1") + camera(*right, "M2", "D2") +
         OpenCvMatrix("R", 3, 3, R) + OpenCvMatrix("T", 3, 1, std::span(T_right_left.t.data(), 3));
}

}  // namespace

const char* NameOf(CalibrationStyle style) { return kStyles[static_cast<size_t>(style)].name; }
const char* UsualFileName(CalibrationStyle style) {
  return kStyles[static_cast<size_t>(style)].file;
}
std::optional<CalibrationStyle> CalibrationStyleNamed(const std::string& name) {
  for (const Style& style : kStyles) {
    if (name == style.name) return style.style;
  }
  return std::nullopt;
}

WrittenCalibration FormatCalibration(const Calibration& calibration, CalibrationStyle style,
                                     const std::string& comment,
                                     const std::optional<ImuModel>& imu) {
  WrittenCalibration written;
  const std::string head = Commented(comment);
  const auto one_of_pair = [&] {
    if (RightOf(calibration))
      Tell(written.told, std::string(style == CalibrationStyle::kRos ? "ROS's" : "COLMAP's") +
                             " file has one camera: only the left one is written");
  };
  switch (style) {
    case CalibrationStyle::kAlidade:
      written.text = head + OwnText(calibration) + (imu ? OwnImu(*imu) : "");
      break;
    case CalibrationStyle::kKalibr:
      written.text = head + KalibrText(calibration, imu, written.told);
      break;
    case CalibrationStyle::kOpenCv:
      written.text = kOpenCvStart + head + OpenCvText(calibration);
      break;
    case CalibrationStyle::kRos:
      one_of_pair();
      written.text = head + RosText(calibration.left);
      break;
    case CalibrationStyle::kColmap:
      one_of_pair();
      written.text = head + EncodeColmapCamera(calibration.left);
      break;
  }
  return written;
}

std::string CommentOfCalibration(const std::string& text) {
  return text.rfind(kOpenCvStart, 0) == 0 ? text.substr(sizeof(kOpenCvStart) - 1) : text;
}

}  // namespace alidade
