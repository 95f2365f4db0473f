#include "alidade/ros/mcap_sink.h"

#include <utility>

#include "alidade/ros/ros_messages.h"

namespace alidade {

McapSink::McapSink(McapWriter::Sink sink, McapCompression compression, const std::string& library)
    : writer_(std::move(sink), "ros2", library, std::move(compression)) {}

void McapSink::Write(const char* topic, RosType type, double time, const std::string& message) {
  auto channel = channels_.find(topic);
  if (channel == channels_.end()) {
    auto schema = schemas_.find(type);
    if (schema == schemas_.end()) {
      const uint16_t id = writer_.AddSchema(NameOf(type), "ros2msg", SchemaOf(type));
      schema = schemas_.emplace(type, id).first;
    }
    // The ros2 profile requires the publishers' QoS; empty: the default.
    const uint16_t id =
        writer_.AddChannel(schema->second, topic, "cdr", {{"offered_qos_profiles", ""}});
    channel = channels_.emplace(topic, id).first;
  }
  writer_.Write(channel->second, RosTime::FromSeconds(time).nanoseconds(), message);
}

}  // namespace alidade
