// Tells the nodes of ROS 2 the name of a participant and its endpoints, as they tell each other:
// `ros2 node list` shows it (design.ros2.org, "Node to Participant mapping").
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/dds/dds_entity.h"

namespace alidade {

// What a participant sees of others that publish, for the layout of the message.
struct NodesSeen {
  bool ros = false;     // nodes of ROS
  bool hashes = false;  // of Iron or later, which tell the hashes of their types
};

// Bytes of an id in the message: 16 since Iron, 24 before. A node that gets the other layout may
// stop to learn of new nodes. By ROS_DISTRO (`distro`; empty: not set), else by the nodes that were
// seen; nullopt: none was, and nothing must be told yet.
std::optional<int> GidBytes(const std::string& distro, const NodesSeen& seen);

class NodeIntroduction {
 public:
  // `participant` outlives this object.
  NodeIntroduction(dds_entity_t participant, std::string node);

  // Calls between two of these have no effect; see Tell().
  bool IsDue();
  // Publishes what has changed; who joins later gets it, too. Does nothing as long as the layout is
  // unknown, and after a failure.
  void Tell(const NodesSeen& seen, const std::vector<dds_entity_t>& readers,
            const std::vector<dds_entity_t>& writers);

 private:
  template <typename Message, typename Node, typename Gid>
  bool Write(const std::vector<dds_guid_t>& readers, const std::vector<dds_guid_t>& writers);
  bool Open(int gid_bytes);

  const dds_entity_t participant_;
  std::string node_;
  dds_time_t next_ = 0;
  std::optional<int> gid_bytes_;
  bool failed_ = false;
  DdsEntity topic_, writer_;
  std::vector<dds_entity_t> told_readers_, told_writers_;
};

// Whether an endpoint with this topic is one by which a node of ROS introduces itself, and not one
// of this class.
bool IsIntroductionOfRos(const char* topic, const dds_qos_t* qos);
// Whether it tells the hash of its type.
bool TellsTypeHash(const dds_qos_t* qos);
// Of a participant with nodes of ROS.
void SetParticipantData(dds_qos_t* qos);

}  // namespace alidade
