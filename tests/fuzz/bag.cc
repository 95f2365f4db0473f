#include "alidade/io/ros/containers/mcap_bag.h"
#include "alidade/io/ros/containers/ros1_bag.h"
#include "alidade/io/ros/containers/rosbag2_database.h"
#include "fuzz/targets.h"
#include "fuzz/use_bag.h"

namespace alidade::fuzz {

void Bag(std::string_view bytes) { UseBag(*OpenRos1Bag(SourceOfBytes(bytes)), bytes.size()); }

void Mcap(std::string_view bytes) { UseBag(*OpenMcapFile(SourceOfBytes(bytes)), bytes.size()); }

void Database(std::string_view bytes) {
  UseBag(*OpenRosbag2DatabaseOf(std::string(bytes)), bytes.size());
}

// The first byte selects the serialization of the rest.
void RosMessage(std::string_view bytes) {
  if (bytes.empty()) return UseMessage(bytes, Serialization::kOther);
  UseMessage(bytes.substr(1), bytes[0] == 'c'   ? Serialization::kCdr
                              : bytes[0] == 'p' ? Serialization::kProtobuf
                                                : Serialization::kRos1);
}

}  // namespace alidade::fuzz
