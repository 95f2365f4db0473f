// Encodes values as ROS 2 messages (CDR).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/cloud.h"

namespace alidade {

// builtin_interfaces/Time.
struct RosTime {
  int32_t sec = 0;
  uint32_t nanosec = 0;

  // Returns the shortest decimal with 6 to 9 digits after the point that equals `seconds`, if there
  // is one, so that the rounding error of a double is not written (1305031102.175304 has no further
  // 64 nanoseconds). Clamps to the range from 0 to the year 2038.
  static RosTime FromSeconds(double seconds);
  uint64_t nanoseconds() const { return static_cast<uint64_t>(sec) * 1000000000u + nanosec; }
};

struct RosHeader {
  RosTime stamp;
  std::string frame_id;
};

struct RosTransform {
  RosTime stamp;
  std::string frame_id, child_frame_id;
  Se3 T_frame_child;
};

struct RosPose {
  RosTime stamp;
  Se3 T_frame_body;
};

struct RosStatus {
  enum Level : uint8_t { kOk = 0, kWarn = 1, kError = 2 } level = kOk;
  std::string name, message, hardware_id;
  std::vector<std::pair<std::string, std::string>> values;
};

enum class RosLogLevel : uint8_t { kInfo = 20, kWarn = 30, kError = 40 };

// geometry_msgs/PoseWithCovariance: the covariance of the error of the position along the axes of
// the header's frame and of the rotation about them (x y z, then rotations about x y z).
struct RosUncertainPose {
  Se3 T_frame_body;
  Matrix6d covariance = Matrix6d::Zero();
};

// nav_msgs/Odometry. Velocities are those of the body along and about its own axes.
struct RosOdometry {
  std::string child_frame_id;
  RosUncertainPose pose;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();      // rad/s
  Matrix6d twist_covariance = Matrix6d::Zero();
};

// nav_msgs/OccupancyGrid. `cells`: row by row from small y, 0 free, 100 occupied, -1 unknown;
// `T_frame_corner`: of the corner of the first one.
struct RosGrid {
  double cell = 0;  // edge length, meters
  uint32_t width = 0, height = 0;
  Se3 T_frame_corner;
  std::vector<int8_t> cells;
};

std::string EncodeTransforms(const std::vector<RosTransform>& transforms);
std::string EncodePose(const RosHeader& header, const Se3& pose);
std::string EncodeUncertainPose(const RosHeader& header, const RosUncertainPose& pose);
std::string EncodeOdometry(const RosHeader& header, const RosOdometry& odometry);
// All in the same frame.
std::string EncodePath(const RosHeader& header, const std::vector<RosPose>& poses);
std::string EncodeGrid(const RosHeader& header, const RosGrid& grid);
// x y z as FLOAT32, and for colored clouds `rgb` as FLOAT32 with the bits 0x00rrggbb, as in the
// Point Cloud Library. Normals and sigmas are omitted.
std::string EncodeCloud(const RosHeader& header, const Cloud& cloud);
std::string EncodeImage(const RosHeader& header, std::string_view format, std::string_view bytes);
// Distortion model plumb_bob with k1 k2 p1 p2 k3, the same order as Camera's. No rectification: r
// is the identity, p is k.
std::string EncodeCameraInfo(const RosHeader& header, const Camera& camera);
std::string EncodeDiagnostics(const RosTime& stamp, const std::vector<RosStatus>& all);
std::string EncodeLog(const RosTime& stamp, RosLogLevel level, std::string_view name,
                      std::string_view text);

}  // namespace alidade
