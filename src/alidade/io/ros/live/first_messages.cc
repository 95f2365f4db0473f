#include "alidade/io/ros/live/first_messages.h"

#include <algorithm>

namespace alidade {
namespace {

bool IsPictureType(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage";
}

// Messages that are kept of a topic: what choosing topics looks at.
size_t MostKept(const std::string& type) {
  if (IsPictureType(type)) return 5;
  return type == kImuType ? 200 : 50;
}

}  // namespace

FirstMessages::FirstMessages(DdsNode& node, const BagQuery& query) : node_(node), query_(query) {}

FirstMessages::~FirstMessages() {
  for (const auto& [subscription, topic] : subscribed_) node_.Unsubscribe(subscription);
}

bool FirstMessages::Wanted(const std::string& topic, const std::string& type) const {
  if (type == kVideoType || !IsWantedType(type)) return false;
  if (IsTransformType(type)) return topic.find("tf_static") != std::string::npos;
  if (!IsPictureType(type) || !query_.image) return true;
  // Without `depth=` or `right=` the partner of a named image is still looked for.
  const auto is = [&](const std::optional<std::string>& name) { return name && *name == topic; };
  return !query_.depth || !query_.right || is(query_.image) || is(query_.depth) || is(query_.right);
}

void FirstMessages::SubscribeToNew() {
  for (const DdsPublication& publication : node_.Publications()) {
    const std::string& type = publication.type;
    if (!Wanted(publication.topic, type)) continue;
    if (!found_.insert(publication.topic + " " + type).second) continue;
    const DdsQuality quality = IsTransformType(type) ? DdsQuality::kLatched : DdsQuality::kSensor;
    std::string problem;
    const int subscription = node_.Subscribe(publication.topic, type, quality,
                                             static_cast<int>(MostKept(type)), &problem);
    if (subscription < 0) {
      warnings_.push_back(publication.topic + ": " + problem);
      continue;
    }
    subscribed_[subscription] = topics_.size();
    topics_.push_back({publication.topic, type, Serialization::kCdr, 0});
    messages_.emplace_back();
  }
}

bool FirstMessages::Gather(double seconds) {
  SubscribeToNew();
  bool first = false;
  for (DdsMessage& message : node_.Take(seconds)) {
    const auto subscribed = subscribed_.find(message.subscription);
    if (subscribed == subscribed_.end()) continue;
    const size_t topic = subscribed->second;
    std::vector<BagMessage>& messages = messages_[topic];
    if (messages.size() >= MostKept(topics_[topic].type)) continue;
    first = first || messages.empty();
    BagMessage kept;
    kept.log_time = message.sent;
    kept.place = kept_.size();
    messages.push_back(kept);
    kept_.push_back(std::move(message.bytes));
    topics_[topic].messages = static_cast<int64_t>(messages.size());
  }
  return first;
}

bool FirstMessages::HasImages() const {
  for (size_t i = 0; i < topics_.size(); ++i) {
    if (IsPictureType(topics_[i].type) && !messages_[i].empty()) return true;
  }
  return false;
}

std::string FirstMessages::Seen() const {
  std::string seen;
  for (const BagTopic& topic : topics_) {
    if (IsPictureType(topic.type)) seen += (seen.empty() ? "" : ", ") + topic.name;
  }
  return seen;
}

std::string FirstMessages::Read(const BagMessage& message, std::string& bytes, uint64_t most) {
  const std::string& kept = kept_[message.place];
  bytes = kept.substr(0, static_cast<size_t>(std::min<uint64_t>(most, kept.size())));
  return {};
}

}  // namespace alidade
