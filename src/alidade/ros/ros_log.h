// Tells a run as ROS 2 messages, to an MCAP file or live. docs/reference/mcap.md lists topics and
// frames.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/cloud.h"
#include "alidade/ros/ros_messages.h"
#include "alidade/ros/ros_schemas.h"

namespace alidade {

// Poses and points refer to `map_optical`, the world of trajectory.txt: x right, y down, z forward
// of the first camera (an optical frame in REP 103). `map` has the same origin with x forward, y
// left, z up, as viewers expect.
inline constexpr char kRosMap[] = "map";
inline constexpr char kRosWorld[] = "map_optical";
inline constexpr char kRosCamera[] = "camera_optical";
// Frame of the images if they were rotated by stereo rectification; otherwise they are in the
// camera's frame.
inline constexpr char kRosRectified[] = "camera_rectified_optical";

// Takes a message (CDR) of a topic, with the time of the recording, seconds.
using RosSink =
    std::function<void(const char* topic, RosType type, double time, const std::string& message)>;

// From an optical frame (x right, y down, z forward) to one of a body (x forward, y left, z up).
Eigen::Matrix3d BodyAxesFromOptical();

class RosLog {
 public:
  explicit RosLog(RosSink sink) : sink_(std::move(sink)) {}

  // See SourceInfo.
  void SetRectification(const Eigen::Matrix3d& R_camera_rectified);

  // All times in seconds. Pose() writes the transforms and, if known, the camera's pose.
  void Pose(double time, const std::optional<Se3>& T_world_camera);
  // The transforms alone, for an updated pose of an earlier frame.
  void Transforms(double time, const std::optional<Se3>& T_world_camera);
  // These three return the size of the message in bytes.
  size_t Path(double time, const std::vector<RosPose>& T_world_camera);
  size_t Landmarks(double time, const Cloud& points_world);
  size_t Shape(double time, const Cloud& points_world);
  void Picture(double time, const std::string& format, const std::string& bytes);
  void Calibration(double time, const Camera& camera);  // of the images
  void Diagnostics(double time, const std::vector<RosStatus>& all);
  void Event(double time, RosLogLevel level, const std::string& text);

 private:
  size_t Write(const char* topic, RosType type, double time, const std::string& message) {
    sink_(topic, type, time, message);
    return message.size();
  }
  std::string PictureFrame() const { return rectification_ ? kRosRectified : kRosCamera; }

  RosSink sink_;
  std::optional<Eigen::Matrix3d> rectification_;
};

}  // namespace alidade
