// ROS 2 message types that are written, and their schemas.
#pragma once

#include <string>

namespace alidade {

enum class RosType {
  kTransforms,          // tf2_msgs/msg/TFMessage
  kPose,                // geometry_msgs/msg/PoseStamped
  kPath,                // nav_msgs/msg/Path
  kCloud,               // sensor_msgs/msg/PointCloud2
  kImage,               // sensor_msgs/msg/CompressedImage
  kCameraInfo,          // sensor_msgs/msg/CameraInfo
  kDiagnostics,         // diagnostic_msgs/msg/DiagnosticArray
  kLog,                 // rcl_interfaces/msg/Log
  kOdometry,            // nav_msgs/msg/Odometry
  kPoseWithCovariance,  // geometry_msgs/msg/PoseWithCovarianceStamped
  kGrid                 // nav_msgs/msg/OccupancyGrid
};

// "tf2_msgs/msg/TFMessage", and "tf2_msgs/TFMessage".
std::string NameOf(RosType type);
std::string ShortNameOf(RosType type);

// Schema in MCAP's encoding "ros2msg": the definition, then those of all types it uses, each after
// a line of 80 '=' and a line with its name.
std::string SchemaOf(RosType type);

}  // namespace alidade
