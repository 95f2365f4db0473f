// Writes ROS 2 messages to one MCAP file.
#pragma once

#include <map>
#include <string>

#include "alidade/ros/mcap_writer.h"
#include "alidade/ros/ros_schemas.h"

namespace alidade {

class McapSink {
 public:
  // `library`: name of the writing program.
  McapSink(McapWriter::Sink sink, McapCompression compression, const std::string& library);

  // A RosSink.
  void Write(const char* topic, RosType type, double time, const std::string& message);
  void Close() { writer_.Close(); }

 private:
  McapWriter writer_;
  std::map<RosType, uint16_t> schemas_;
  std::map<std::string, uint16_t> channels_;
};

}  // namespace alidade
