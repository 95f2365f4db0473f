// Values as the bytes of ROS 2 messages (CDR).
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

  // The decimal with 6 to 9 digits behind the point that `seconds` was read from, where there is
  // one: 1305031102.175304 has no 64 nanoseconds more, whatever a double makes of it. Below 0 and
  // beyond 2038: what is nearest to it.
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

std::string EncodeTransforms(const std::vector<RosTransform>& transforms);
std::string EncodePose(const RosHeader& header, const Se3& pose);
std::string EncodePath(const RosHeader& header, const std::vector<RosPose>& poses);  // same frame
// x y z as FLOAT32, and `rgb` where the cloud has colours: FLOAT32 whose bits are 0x00rrggbb, as
// the Point Cloud Library has it. Normals and sigmas are left out.
std::string EncodeCloud(const RosHeader& header, const Cloud& cloud);
std::string EncodeImage(const RosHeader& header, std::string_view format, std::string_view bytes);
// plumb_bob is k1 k2 p1 p2 k3, as ours. No rectification: r is 1, p is k.
std::string EncodeCameraInfo(const RosHeader& header, const Camera& camera);
std::string EncodeDiagnostics(const RosTime& stamp, const std::vector<RosStatus>& all);
std::string EncodeLog(const RosTime& stamp, RosLogLevel level, std::string_view name,
                      std::string_view text);

}  // namespace alidade
