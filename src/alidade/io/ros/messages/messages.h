// The messages of sensor_msgs that contain images, calibrations and inertial readings, and those of
// transforms, for ROS 1 and ROS 2.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/io/ros/camera_info.h"
#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

struct MessageHeader {
  int64_t stamp = 0;  // nanoseconds; 0: not set
  std::string frame_id;
};

// sensor_msgs/Image or sensor_msgs/CompressedImage. `data` refers to the message's bytes.
struct RosPicture {
  MessageHeader header;
  bool compressed = false;
  std::string encoding;  // "bgr8"; for compressed images "rgb8; jpeg compressed bgr8" and similar
  // Size in pixels and bytes per row; not set for compressed images.
  uint32_t width = 0, height = 0, step = 0;
  bool big_endian = false;
  std::string_view data;
};

// sensor_msgs/CameraInfo.
struct RosCameraInfo : CameraInfo {
  MessageHeader header;
};

// sensor_msgs/Imu. Orientation and covariances are ignored, but for a first element of -1: the
// quantity is not there.
struct RosImu {
  MessageHeader header;
  Eigen::Vector3d angular_velocity;     // rad/s
  Eigen::Vector3d linear_acceleration;  // m/s², with gravity
  bool has_rate = true, has_force = true;
};

// One transform of tf2_msgs/TFMessage.
struct RosFrame {
  std::string parent, child;
  Se3 T_parent_child;
};

// All throw Error (input) when the message is damaged.
MessageHeader ParseRosHeader(std::string_view message, Serialization serialization);
RosPicture ParseRosPicture(std::string_view message, Serialization serialization, bool compressed);
RosImu ParseRosImu(std::string_view message, Serialization serialization);
std::vector<RosFrame> ParseRosTransforms(std::string_view message, Serialization serialization);
RosCameraInfo ParseRosCameraInfo(std::string_view message, Serialization serialization);

}  // namespace alidade
