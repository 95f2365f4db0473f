// A run as ROS 2 messages in one MCAP file; topics and frames: docs/reference/mcap.md.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/cloud.h"
#include "alidade/ros/mcap_writer.h"
#include "alidade/ros/ros_messages.h"
#include "alidade/ros/ros_schemas.h"

namespace alidade {

// Poses and points are told in the world they are known in, that of trajectory.txt: x right, y
// down, z forward as the first camera looked (REP 103 calls such frames optical). `map` is the same
// place with x forward, y left, z up, which viewers expect of it.
inline constexpr char kRosMap[] = "map";
inline constexpr char kRosWorld[] = "map_optical";
inline constexpr char kRosCamera[] = "camera_optical";
// That of the pictures, where they were turned to be rectified (stereo); else they are the
// camera's.
inline constexpr char kRosRectified[] = "camera_rectified_optical";

class RosLog {
 public:
  // `library`: who wrote it. `R_camera_rectified`: see SourceInfo.
  RosLog(McapWriter::Sink sink, McapCompression compression, const std::string& library);

  void SetRectification(const Eigen::Matrix3d& R_camera_rectified);

  // All times in seconds. A frame: where the fixed frames are and, if known, the camera.
  void Pose(double time, const std::optional<Se3>& T_world_camera);
  // The transform alone: what was learnt of a camera that was told before.
  void Transforms(double time, const std::optional<Se3>& T_world_camera);
  // These three give the bytes it took.
  size_t Path(double time, const std::vector<RosPose>& T_world_camera);
  size_t Landmarks(double time, const Cloud& points_world);
  size_t Shape(double time, const Cloud& points_world);
  void Picture(double time, const std::string& format, const std::string& bytes);
  void Calibration(double time, const Camera& camera);  // of the pictures
  void Diagnostics(double time, const std::vector<RosStatus>& all);
  void Event(double time, RosLogLevel level, const std::string& text);
  void Close() { writer_.Close(); }

 private:
  size_t Write(const char* topic, RosType type, double time, const std::string& message);
  std::string PictureFrame() const { return rectification_ ? kRosRectified : kRosCamera; }

  McapWriter writer_;
  std::map<RosType, uint16_t> schemas_;
  std::map<std::string, uint16_t> channels_;
  std::optional<Eigen::Matrix3d> rectification_;
};

}  // namespace alidade
