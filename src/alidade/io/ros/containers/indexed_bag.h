// Base of the readers of all container formats: the topics, and the locations of messages of wanted
// types.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

class IndexedBag : public BagFile {
 public:
  const std::vector<BagTopic>& Topics() const override { return topics_; }
  const std::vector<BagMessage>& Messages(size_t topic) const override { return messages_[topic]; }
  const std::vector<std::string>& Warnings() const override { return warnings_; }

 protected:
  // Index of the topic with this name and type, added if new. ROS 1 may have several connections
  // (publishers) per topic.
  size_t TopicOf(std::string_view name, std::string_view type, Serialization serialization);
  void Add(size_t topic, const BagMessage& message) {
    ++topics_[topic].messages;
    if (wanted_[topic]) messages_[topic].push_back(message);
  }
  void Count(size_t topic, int64_t messages) { topics_[topic].messages += messages; }
  bool IsWanted(size_t topic) const { return wanted_[topic]; }
  void Warn(const std::string& warning);
  void SortByTime();
  // Fills the topics and messages by `index`, then sorts them by time. If `index` throws, `forget`
  // must reset the container's own state, and `scan` reads the file from its start.
  template <typename Index, typename Forgetting, typename Scan>
  void FillByIndexOr(Index index, Forgetting forget, Scan scan) {
    try {
      index();
    } catch (const Error& error) {
      Forget();
      forget();
      Warn(std::string("has no usable index (it ") + error.what() + ") and is read from its start");
      scan();
    }
    SortByTime();
  }

 private:
  void Forget();

  std::vector<BagTopic> topics_;
  std::vector<std::vector<BagMessage>> messages_;
  std::vector<bool> wanted_;
  std::map<std::pair<std::string, std::string>, size_t> known_;
  std::vector<std::string> warnings_;
};

// The ROS 1 spelling of a type: "sensor_msgs/Image" for ROS 2's "sensor_msgs/msg/Image".
std::string Ros1TypeOf(std::string_view type);

// Value of BagMessage::offset for a message whose record is stored in the file itself, not in a
// packed chunk.
inline constexpr uint32_t kUnpacked = std::numeric_limits<uint32_t>::max();

inline constexpr int64_t kNanoseconds = 1'000'000'000;

}  // namespace alidade
