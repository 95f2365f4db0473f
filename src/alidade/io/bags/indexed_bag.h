// What the readers of all containers fill: topics, and where the messages of the wanted ones are.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "alidade/io/bags/bags_module.h"

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
  void Forget();  // all of the above, for another try

 private:
  std::vector<BagTopic> topics_;
  std::vector<std::vector<BagMessage>> messages_;
  std::vector<bool> wanted_;
  std::map<std::pair<std::string, std::string>, size_t> known_;
  std::vector<std::string> warnings_;
};

// "sensor_msgs/msg/Image", as ROS 2 and its IDL have it, as ROS 1 has it: "sensor_msgs/Image".
std::string Ros1TypeOf(std::string_view type);

inline constexpr int64_t kNanoseconds = 1'000'000'000;

}  // namespace alidade
