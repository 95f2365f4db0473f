// What the readers of all containers fill: topics, and where the messages of the wanted ones are.
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
  // The topic of that name and type, a new one when there is none. ROS 1 allows several publishers,
  // and so several connections, on one topic.
  size_t TopicOf(std::string_view name, std::string_view type, Serialization serialization);
  void Add(size_t topic, const BagMessage& message) {
    ++topics_[topic].messages;
    if (wanted_[topic]) messages_[topic].push_back(message);
  }
  void Count(size_t topic, int64_t messages) { topics_[topic].messages += messages; }
  bool IsWanted(size_t topic) const { return wanted_[topic]; }
  void Warn(const std::string& warning);
  void SortByTime();
  // Fills all of the above by the file's own index, then sorts by time. Where the index cannot be
  // used, `scan` reads the file from its start instead, after `forget` has dropped what the
  // container itself had taken from it.
  template <typename Index, typename Forgetting, typename Scan>
  void FillByIndexOr(Index index, Forgetting forget, Scan scan) {
    try {
      index();
    } catch (const Error& error) {
      Forget();
      forget();
      Warn(std::string("has no index that can be used (it ") + error.what() +
           "): read from its start");
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

// "sensor_msgs/msg/Image", as ROS 2 and its IDL have it, as ROS 1 has it: "sensor_msgs/Image".
std::string Ros1TypeOf(std::string_view type);

// As a message's offset: its record stands in the file itself at its place, not in a packed chunk.
inline constexpr uint32_t kUnpacked = std::numeric_limits<uint32_t>::max();

inline constexpr int64_t kNanoseconds = 1'000'000'000;

}  // namespace alidade
