// The types of ROS 2 messages that are written, and what readers are told of them.
#pragma once

#include <string>

namespace alidade {

enum class RosType {
  kTransforms,   // tf2_msgs/msg/TFMessage
  kPose,         // geometry_msgs/msg/PoseStamped
  kPath,         // nav_msgs/msg/Path
  kCloud,        // sensor_msgs/msg/PointCloud2
  kImage,        // sensor_msgs/msg/CompressedImage
  kCameraInfo,   // sensor_msgs/msg/CameraInfo
  kDiagnostics,  // diagnostic_msgs/msg/DiagnosticArray
  kLog           // rcl_interfaces/msg/Log
};

// "tf2_msgs/msg/TFMessage".
std::string NameOf(RosType type);

// MCAP's "ros2msg": the definition, then those of all types it is made of, each behind a line of 80
// '=' and one with its name.
std::string SchemaOf(RosType type);

}  // namespace alidade
