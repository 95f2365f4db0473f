#include "alidade/ros/ros_log.h"

namespace alidade {
namespace {

RosHeader HeaderIn(const std::string& frame, double time) {
  return {RosTime::FromSeconds(time), frame};
}

}  // namespace

Eigen::Matrix3d BodyAxesFromOptical() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

void RosLog::SetRectification(const Eigen::Matrix3d& R_camera_rectified) {
  rectification_.reset();
  if (!R_camera_rectified.isIdentity(0)) rectification_ = R_camera_rectified;
}

void RosLog::Pose(double time, const std::optional<Se3>& T_world_camera) {
  Transforms(time, T_world_camera);
  if (!T_world_camera) return;
  Write("/alidade/pose", RosType::kPose, time,
        EncodePose(HeaderIn(kRosWorld, time), *T_world_camera));
}

// Static transforms are repeated with every frame. With a separate topic (/tf_static) readers would
// have to read the recording from its beginning.
void RosLog::Transforms(double time, const std::optional<Se3>& T_world_camera) {
  const RosTime stamp = RosTime::FromSeconds(time);
  std::vector<RosTransform> transforms;
  if (T_world_camera) transforms.push_back({stamp, kRosWorld, kRosCamera, *T_world_camera});
  transforms.push_back(
      {stamp, kRosMap, kRosWorld, {BodyAxesFromOptical(), Eigen::Vector3d::Zero()}});
  if (rectification_) {
    transforms.push_back(
        {stamp, kRosCamera, kRosRectified, {*rectification_, Eigen::Vector3d::Zero()}});
  }
  Write("/tf", RosType::kTransforms, time, EncodeTransforms(transforms));
}

size_t RosLog::Path(double time, const std::vector<RosPose>& T_world_camera) {
  return Write("/alidade/path", RosType::kPath, time,
               EncodePath(HeaderIn(kRosWorld, time), T_world_camera));
}

size_t RosLog::Landmarks(double time, const Cloud& points_world) {
  return Write("/alidade/landmarks", RosType::kCloud, time,
               EncodeCloud(HeaderIn(kRosWorld, time), points_world));
}

size_t RosLog::Shape(double time, const Cloud& points_world) {
  return Write("/alidade/semidense", RosType::kCloud, time,
               EncodeCloud(HeaderIn(kRosWorld, time), points_world));
}

void RosLog::Picture(double time, const std::string& format, const std::string& bytes) {
  Write("/camera/image/compressed", RosType::kImage, time,
        EncodeImage(HeaderIn(PictureFrame(), time), format, bytes));
}

void RosLog::Calibration(double time, const Camera& camera) {
  Write("/camera/camera_info", RosType::kCameraInfo, time,
        EncodeCameraInfo(HeaderIn(PictureFrame(), time), camera));
}

void RosLog::Diagnostics(double time, const std::vector<RosStatus>& all) {
  Write("/diagnostics", RosType::kDiagnostics, time,
        EncodeDiagnostics(RosTime::FromSeconds(time), all));
}

void RosLog::Event(double time, RosLogLevel level, const std::string& text) {
  Write("/alidade/events", RosType::kLog, time,
        EncodeLog(RosTime::FromSeconds(time), level, "alidade", text));
}

}  // namespace alidade
