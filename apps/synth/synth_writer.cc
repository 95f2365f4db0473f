#include "synth/synth_writer.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/sources/synth_source.h"
#include "synth/imu_text.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::string Print(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}
class FolderWriter : public SynthWriter {
 public:
  FolderWriter(std::string folder, const Camera& camera, const std::vector<std::string>& parts)
      : folder_(std::move(folder)), camera_(camera) {
    for (const std::string& part : parts) MakeFolder(part);
  }

 protected:
  void MakeFolder(const std::string& part) const {
    std::error_code error;
    fs::create_directories(folder_ + "/" + part, error);
    if (error)
      ThrowInput("cannot create the folder " + folder_ + "/" + part + ": " + error.message());
  }
  void WriteImages(const std::vector<std::pair<std::string, cv::Mat>>& images) const {
    ParallelFor(static_cast<int>(images.size()),
                [&](int i) { WriteImage(folder_ + "/" + images[i].first, images[i].second); });
  }
  void WriteText(const std::string& name, const std::string& text) const {
    AtomicWriteFile(folder_ + "/" + name, text);
  }
  const Camera& camera() const { return camera_; }

 private:
  std::string folder_;
  Camera camera_;
};

// Sturm et al. 2012: lists of stamped images, poses as stamp, position and quaternion.
class TumWriter : public FolderWriter {
 public:
  TumWriter(const std::string& folder, const Camera& camera, bool fisheye)
      : FolderWriter(folder, camera, {"rgb", "depth", "mask"}), fisheye_(fisheye) {}

  void AddReadings(const WrittenImu& imu) override {
    WriteText("imu.csv", FormatImuCsv(imu.samples));
    // As a phone's archive has them, where nothing is known of the sensor.
    if (!imu.model.rotation_known) WriteText("motion.csv", FormatMotionCsv(imu.samples));
    imu_block_ = FormatImuBlock(imu.model);
  }

  void Add(const RenderedFrame& frame, const Se3& T_world_camera) override {
    const std::string stamp = SynthStamp(frame.time), file = "/" + stamp + ".png";
    WriteImages(
        {{"rgb" + file, frame.image}, {"depth" + file, frame.depth}, {"mask" + file, frame.mask}});
    for (const auto& [list, part] :
         {std::pair(&rgb_, "rgb"), std::pair(&depth_, "depth"), std::pair(&mask_, "mask")}) {
      *list += stamp + " " + part + file + "\n";
    }
    truth_.push_back({frame.time, T_world_camera, stamp});
  }

  void Finish() override {
    const Camera& c = camera();
    // All four coefficients are 0: exactly equidistant.
    const std::vector<double> distortion(c.distortion.begin(),
                                         c.distortion.begin() + (fisheye_ ? 4 : 5));
    WriteText("camera.yaml",
              std::string("model: ") + (fisheye_ ? "fisheye" : "pinhole") +
                  "\nwidth: " + std::to_string(c.width) + "\nheight: " + std::to_string(c.height) +
                  "\nfx: " + ExactText(c.fx) + "\nfy: " + ExactText(c.fy) +
                  "\ncx: " + ExactText(c.cx) + "\ncy: " + ExactText(c.cy) + "\ndistortion: [" +
                  JoinNumbers(distortion, ", ") + "]\nfps: " + ExactText(c.fps) +
                  "\nreadout: " + ExactText(c.readout[1]) +
                  "\ndepth_factor: " + ExactText(c.depth_factor) + "\n" + imu_block_);
    WriteText("groundtruth.txt", FormatTumTrajectory(truth_));
    WriteText("mask.txt", "# timestamp file (255 = moving people)\n" + mask_);
    WriteText("depth.txt", "# timestamp file\n" + depth_);
    WriteText("rgb.txt", "# timestamp file\n" + rgb_);
  }

 private:
  bool fisheye_;
  std::string rgb_, depth_, mask_, imu_block_;
  Trajectory truth_;
};

// Burri et al. 2016. The body frame has x forward and z up; its origin is the left camera's center.
class EurocWriter : public FolderWriter {
 public:
  EurocWriter(const std::string& folder, const Camera& camera)
      : FolderWriter(folder, camera,
                     {"mav0/cam0/data", "mav0/cam1/data", "mav0/depth0/data", "mav0/mask0/data",
                      "mav0/state_groundtruth_estimate0"}) {
    T_body_camera_.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  }

  void AddReadings(const WrittenImu& imu) override {
    MakeFolder("mav0/imu0");
    WriteText("mav0/imu0/sensor.yaml", FormatEurocImuSensor(imu.model, T_body_camera_));
    WriteText("mav0/imu0/data.csv", FormatEurocImu(imu.samples, kSynthEurocStart));
  }

  void Add(const RenderedFrame& frame, const Se3& T_world_camera) override {
    const std::string stamp = std::to_string(kSynthEurocStart * 1'000'000'000LL +
                                             std::llround(frame.time * 1e9)),
                      file = "/data/" + stamp + ".png";
    WriteImages({{"mav0/cam0" + file, frame.image},
                 {"mav0/cam1" + file, frame.right},
                 {"mav0/depth0" + file, frame.depth},
                 {"mav0/mask0" + file, frame.mask}});
    list_ += stamp + "," + stamp + ".png\n";
    const Se3 T_world_body = T_world_camera * T_body_camera_.Inverse();
    const Eigen::Quaterniond q = T_world_body.Quaternion();
    const Eigen::Vector3d& t = T_world_body.t;
    truth_ +=
        stamp + "," + JoinNumbers({t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}, ",") + "\n";
  }

  void Finish() override {
    WriteText("mav0/state_groundtruth_estimate0/data.csv",
              "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y "
              "[],q_RS_z []\n" +
                  truth_);
    const Se3 beside{Eigen::Matrix3d::Identity(), {camera().baseline, 0, 0}};
    WriteText("mav0/cam0/sensor.yaml", Sensor("left camera", T_body_camera_));
    WriteText("mav0/cam1/sensor.yaml", Sensor("right camera", T_body_camera_ * beside));
    const std::string head = "#timestamp [ns],filename\n";
    for (const char* part : {"cam1", "depth0", "mask0", "cam0"})
      WriteText(std::string("mav0/") + part + "/data.csv", head + list_);
  }

 private:
  std::string Sensor(const std::string& comment, const Se3& T_body_sensor) const {
    const Camera& c = camera();
    const auto& k = c.distortion;
    return "# " + comment + ", rendered\nsensor_type: camera\ncomment: rendered " + comment +
           "\nT_BS:\n  cols: 4\n  rows: 4\n  data: [" + MatrixText(T_body_sensor, 4, ", ") +
           "]\nrate_hz: " + ExactText(c.fps) + "\nresolution: [" + std::to_string(c.width) + ", " +
           std::to_string(c.height) + "]\ncamera_model: pinhole\nintrinsics: [" +
           JoinNumbers({c.fx, c.fy, c.cx, c.cy}, ", ") +
           "]\ndistortion_model: radial-tangential\ndistortion_coefficients: [" +
           JoinNumbers({k[0], k[1], k[2], k[3]}, ", ") + "]\n";
  }

  Se3 T_body_camera_;
  std::string list_, truth_;
};

// Geiger et al. 2012, odometry: numbered images, poses in the first camera's frame.
class KittiWriter : public FolderWriter {
 public:
  KittiWriter(const std::string& folder, const Camera& camera)
      : FolderWriter(folder, camera, {"image_0", "image_1", "depth", "mask"}) {
    if (camera.HasDistortion())
      ThrowUsage("--distortion requires --format tum or euroc: KITTI recordings are rectified");
  }

  void Add(const RenderedFrame& frame, const Se3& T_world_camera) override {
    char file[32];
    std::snprintf(file, sizeof(file), "/%06d.png", count_);
    WriteImages({{std::string("image_0") + file, frame.image},
                 {std::string("image_1") + file, frame.right},
                 {std::string("depth") + file, frame.depth},
                 {std::string("mask") + file, frame.mask}});
    if (count_ == 0) T_first_world_ = T_world_camera.Inverse();
    times_ += Print("%.9e", frame.time) + "\n";
    poses_ += MatrixText(T_first_world_ * T_world_camera, 3, " ") + "\n";
    ++count_;
  }

  void AddReadings(const WrittenImu&) override {}  // refused by the command

  void Finish() override {
    const Camera& c = camera();
    std::string calibration;
    for (int i = 0; i < 4; ++i) {
      const double shift = i % 2 == 1 ? -c.fx * c.baseline : 0;
      calibration += "P" + std::to_string(i) + ": " +
                     JoinNumbers({c.fx, 0, c.cx, shift, 0, c.fy, c.cy, 0, 0, 0, 1, 0}, " ") + "\n";
    }
    WriteText("calib.txt", calibration);
    WriteText("poses.txt", poses_);
    WriteText("times.txt", times_);
  }

 private:
  int count_ = 0;
  Se3 T_first_world_;
  std::string times_, poses_;
};

}  // namespace

std::unique_ptr<SynthWriter> MakeSynthWriter(SynthFormat format, const std::string& folder,
                                             const Camera& camera, bool fisheye) {
  switch (format) {
    case SynthFormat::kTum:
      return std::make_unique<TumWriter>(folder, camera, fisheye);
    case SynthFormat::kEuroc:
      return std::make_unique<EurocWriter>(folder, camera);
    case SynthFormat::kKitti:
      return std::make_unique<KittiWriter>(folder, camera);
  }
  ThrowUsage("unknown format");
}

}  // namespace alidade
