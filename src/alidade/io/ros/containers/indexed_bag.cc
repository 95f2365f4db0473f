#include "alidade/io/ros/containers/indexed_bag.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/printable.h"

namespace alidade {
namespace {

// Recordings have a few hundred topics. The limit bounds the memory a crafted file can use.
constexpr size_t kMostTopics = 100'000;
constexpr size_t kMostWarnings = 5;

bool IsWantedTopic(const BagTopic& topic) {
  if (topic.serialization == Serialization::kProtobuf)
    return topic.type == kVideoType || topic.type == kCalibrationType;
  return topic.serialization != Serialization::kOther && IsWantedType(topic.type);
}

}  // namespace

size_t IndexedBag::TopicOf(std::string_view name, std::string_view type,
                           Serialization serialization) {
  const auto [found, is_new] =
      known_.try_emplace({std::string(name), std::string(type)}, topics_.size());
  if (is_new) {
    if (topics_.size() == kMostTopics) ThrowInput("lists an impossible number of topics");
    topics_.push_back({Printable(name), Printable(Ros1TypeOf(type)), serialization, 0});
    messages_.emplace_back();
    wanted_.push_back(IsWantedTopic(topics_.back()));
  }
  return found->second;
}

void IndexedBag::Warn(const std::string& warning) {
  if (warnings_.size() < kMostWarnings) warnings_.push_back(warning);
}

void IndexedBag::SortByTime() {
  for (std::vector<BagMessage>& messages : messages_) {
    std::stable_sort(
        messages.begin(), messages.end(),
        [](const BagMessage& a, const BagMessage& b) { return a.log_time < b.log_time; });
  }
}

void IndexedBag::Forget() {
  topics_.clear();
  messages_.clear();
  wanted_.clear();
  known_.clear();
  warnings_.clear();
}

std::string Ros1TypeOf(std::string_view type) {
  std::string plain(type);
  // some bridges write "sensor_msgs::msg::dds_::Image_"
  for (size_t at = plain.find("::"); at != std::string::npos; at = plain.find("::"))
    plain.replace(at, 2, "/");
  // Protocol Buffers, and IDL of the same schema.
  if (plain == "foxglove.CompressedVideo" || plain == "foxglove/CompressedVideo") return kVideoType;
  if (plain == "foxglove.CameraCalibration" || plain == "foxglove/CameraCalibration")
    return kCalibrationType;
  const size_t middle = plain.find("/msg/");
  if (middle != std::string::npos) plain.erase(middle, 4);
  const size_t dds = plain.find("/dds_/");
  if (dds != std::string::npos && plain.back() == '_') {
    plain.pop_back();
    plain.erase(dds, 5);
  }
  return plain;
}

}  // namespace alidade
