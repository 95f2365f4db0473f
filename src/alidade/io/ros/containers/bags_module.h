// What libalidade_bags.so offers: files of stamped messages, whatever their container. It is loaded
// by io/ros/source/bag_file.cc when such a file is first met, and linked by nobody. Both sides are
// built together: the interface may hold C++ types, only its name is C. No exception but
// std::bad_alloc leaves the module.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace alidade {

// How messages are laid out.
enum class Serialization { kRos1, kCdr, kOther };

struct BagTopic {
  std::string name;  // "/cam0/image_raw"
  std::string type;  // "sensor_msgs/Image", as ROS 1 has it: what ROS 2 calls sensor_msgs/msg/Image
  Serialization serialization = Serialization::kOther;
  int64_t messages = 0;  // all there are, indexed or not
};

// Where one message is. `place` and `offset` are the container's own.
struct BagMessage {
  int64_t log_time = 0;  // when it was written down, nanoseconds
  uint64_t place = 0;
  uint32_t offset = 0;
  uint32_t file = 0;  // of recordings in several files
};

// A recording. Not thread-safe.
class BagFile {
 public:
  virtual ~BagFile() = default;
  virtual const std::vector<BagTopic>& Topics() const = 0;
  // Of a topic whose type is wanted (see WantedTypes()), in the order of log times; else empty.
  virtual const std::vector<BagMessage>& Messages(size_t topic) const = 0;
  // Reads a message, or its first bytes, `most` or more of them (all, where they cannot be had for
  // less). Not empty: why it cannot be read, for people.
  virtual std::string Read(const BagMessage& message, std::string& bytes,
                           uint64_t most = kWholeMessage) = 0;
  static constexpr uint64_t kWholeMessage = ~uint64_t{0};
  // What was found to be damaged when it was opened.
  virtual const std::vector<std::string>& Warnings() const = 0;
};

// Types whose messages are looked for; of others only how many there are.
inline bool IsWantedType(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage" ||
         type == "sensor_msgs/CameraInfo";
}

inline constexpr char kBagsModuleFile[] = "libalidade_bags.so";

// `paths`: the parts of one recording, in order. Null with a `problem` when it cannot be read.
using BagOpenFunction = BagFile*(const std::vector<std::string>& paths, std::string* problem);

}  // namespace alidade
