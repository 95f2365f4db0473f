// Interface of libalidade_bags.so, which reads files of stamped messages in several container
// formats. io/ros/source/bag_file.cc loads it on first use; no target links it. The program and the
// module are built together, so the interface may use C++ types; only the function name is C. Only
// std::bad_alloc may leave the module as an exception.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace alidade {

// Encoding of a message's fields.
enum class Serialization { kRos1, kCdr, kProtobuf, kOther };

struct BagTopic {
  std::string name;  // "/cam0/image_raw"
  std::string type;  // ROS 1 spelling "sensor_msgs/Image", also for ROS 2's sensor_msgs/msg/Image
  Serialization serialization = Serialization::kOther;
  int64_t messages = 0;  // number of all messages, including those of unwanted types
};

// Location of one message. The meaning of `place` and `offset` depends on the container.
struct BagMessage {
  int64_t log_time = 0;  // time of recording, nanoseconds
  uint64_t place = 0;
  uint32_t offset = 0;
  uint32_t file = 0;  // index of the file in a recording of several files
};

// One recording. Not thread-safe.
class BagFile {
 public:
  virtual ~BagFile() = default;
  virtual const std::vector<BagTopic>& Topics() const = 0;
  // Messages of a topic in order of log time. Empty unless IsWantedType() holds for the topic's
  // type.
  virtual const std::vector<BagMessage>& Messages(size_t topic) const = 0;
  // Reads a message, or at least its first `most` bytes if it is longer (possibly all of it, where
  // a part costs as much). Returns an empty string, or for users why the message cannot be read.
  virtual std::string Read(const BagMessage& message, std::string& bytes,
                           uint64_t most = kWholeMessage) = 0;
  static constexpr uint64_t kWholeMessage = ~uint64_t{0};
  // Damage found when the recording was opened.
  virtual const std::vector<std::string>& Warnings() const = 0;
};

// foxglove.CompressedVideo and foxglove.CameraCalibration, in any encoding.
inline constexpr char kVideoType[] = "foxglove_msgs/CompressedVideo";
inline constexpr char kCalibrationType[] = "foxglove_msgs/CameraCalibration";

inline bool IsInfoType(const std::string& type) {
  return type == "sensor_msgs/CameraInfo" || type == kCalibrationType;
}

inline constexpr char kImuType[] = "sensor_msgs/Imu";
inline bool IsTransformType(const std::string& type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
}

// Types whose messages are indexed; messages of other types are only counted.
inline bool IsWantedType(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage" ||
         type == kVideoType || IsInfoType(type) || type == kImuType || IsTransformType(type);
}

inline constexpr char kBagsModuleFile[] = "libalidade_bags.so";

// Opens the parts of one recording, given in order. Returns null and sets `problem` when nothing
// can be read.
using BagOpenFunction = BagFile*(const std::vector<std::string>& paths, std::string* problem);

}  // namespace alidade
