#include "alidade/io/dds/node_introduction.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>

#include "ros2_types.h"  // by idlc

namespace alidade {
namespace {

constexpr char kIntroductions[] = "ros_discovery_info";
constexpr char kTypeName[] = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
constexpr dds_duration_t kInterval = DDS_SECS(1);
// In the user data of endpoints (key=value;): what marks our own among those of ROS, and what
// nodes since Iron add to all of theirs.
constexpr char kOurs[] = "alidade=1;";
constexpr std::string_view kTypeHash = "typehash=";

std::string UserDataOf(const dds_qos_t* qos) {
  void* data = nullptr;
  size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size) || data == nullptr) return {};
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

std::vector<dds_guid_t> GuidsOf(const std::vector<dds_entity_t>& entities) {
  std::vector<dds_guid_t> guids;
  for (const dds_entity_t entity : entities) {
    dds_guid_t guid{};
    if (dds_get_guid(entity, &guid) == DDS_RETCODE_OK) guids.push_back(guid);
  }
  return guids;
}

template <typename Gid>
Gid GidOf(const dds_guid_t& guid) {
  Gid gid{};
  std::copy(std::begin(guid.v), std::end(guid.v), std::begin(gid.data));
  return gid;
}

template <typename Sequence, typename Element>
void Refer(Sequence& sequence, std::vector<Element>& elements) {
  sequence._length = sequence._maximum = static_cast<uint32_t>(elements.size());
  sequence._buffer = elements.data();
}

}  // namespace

std::optional<int> GidBytes(const std::string& distro, const NodesSeen& seen) {
  constexpr int kUntilHumble = 24, kSinceIron = 16;
  constexpr const char* kOld[] = {"foxy", "galactic", "humble"};
  if (std::find(std::begin(kOld), std::end(kOld), distro) != std::end(kOld)) return kUntilHumble;
  if (!distro.empty() || seen.hashes) return kSinceIron;
  if (seen.ros) return kUntilHumble;
  return std::nullopt;
}

bool IsIntroductionOfRos(const char* topic, const dds_qos_t* qos) {
  return std::strcmp(topic, kIntroductions) == 0 &&
         UserDataOf(qos).find(kOurs) == std::string::npos;
}

bool TellsTypeHash(const dds_qos_t* qos) {
  return UserDataOf(qos).find(kTypeHash) != std::string::npos;
}

void SetParticipantData(dds_qos_t* qos) {
  constexpr std::string_view kEnclave = "enclave=/;";
  dds_qset_userdata(qos, kEnclave.data(), kEnclave.size());
}

NodeIntroduction::NodeIntroduction(dds_entity_t participant, std::string node)
    : participant_(participant), node_(std::move(node)) {}

bool NodeIntroduction::IsDue() {
  const dds_time_t now = dds_time();
  if (failed_ || now < next_) return false;
  next_ = now + kInterval;
  return true;
}

// As rmw: reliable, and the last message is kept for those who join later.
bool NodeIntroduction::Open(int gid_bytes) {
  static const dds_topic_descriptor_t until_humble = [] {
    dds_topic_descriptor_t type = until_humble_ParticipantEntitiesInfo__desc;
    type.m_typename = kTypeName;
    return type;
  }();
  const dds_topic_descriptor_t* type = gid_bytes == sizeof(until_humble_Gid_::data)
                                           ? &until_humble
                                           : &rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc;
  const Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  const dds_data_representation_id_t plain_cdr = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &plain_cdr);
  dds_qset_userdata(qos.get(), kOurs, sizeof kOurs - 1);
  topic_ = DdsEntity(dds_create_topic(participant_, type, kIntroductions, nullptr, nullptr));
  if (topic_.valid())
    writer_ = DdsEntity(dds_create_writer(participant_, topic_.get(), qos.get(), nullptr));
  return writer_.valid();
}

template <typename Message, typename Node, typename Gid>
bool NodeIntroduction::Write(const std::vector<dds_guid_t>& readers,
                             const std::vector<dds_guid_t>& writers) {
  std::vector<Gid> reader_gids, writer_gids;
  std::transform(readers.begin(), readers.end(), std::back_inserter(reader_gids), GidOf<Gid>);
  std::transform(writers.begin(), writers.end(), std::back_inserter(writer_gids), GidOf<Gid>);
  std::string root = "/";
  std::vector<Node> nodes(1);
  nodes.front().node_namespace = root.data();
  nodes.front().node_name = node_.data();
  Refer(nodes.front().reader_gid_seq, reader_gids);
  Refer(nodes.front().writer_gid_seq, writer_gids);
  dds_guid_t own{};
  dds_get_guid(participant_, &own);
  Message message{};
  message.gid = GidOf<Gid>(own);
  Refer(message.node_entities_info_seq, nodes);
  return dds_write(writer_.get(), &message) == DDS_RETCODE_OK;
}

void NodeIntroduction::Tell(const NodesSeen& seen, const std::vector<dds_entity_t>& readers,
                            const std::vector<dds_entity_t>& writers) {
  if (failed_) return;
  if (!gid_bytes_) {
    const char* distro = std::getenv("ROS_DISTRO");
    gid_bytes_ = GidBytes(distro == nullptr ? "" : distro, seen);
    if (!gid_bytes_) return;
    failed_ = !Open(*gid_bytes_);
    if (failed_) return;
  } else if (readers == told_readers_ && writers == told_writers_) {
    return;
  }
  const std::vector<dds_guid_t> of_readers = GuidsOf(readers), of_writers = GuidsOf(writers);
  const bool told =
      *gid_bytes_ == sizeof(until_humble_Gid_::data)
          ? Write<until_humble_ParticipantEntitiesInfo_, until_humble_NodeEntitiesInfo_,
                  until_humble_Gid_>(of_readers, of_writers)
          : Write<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_,
                  rmw_dds_common_msg_dds__NodeEntitiesInfo_, rmw_dds_common_msg_dds__Gid_>(
                of_readers, of_writers);
  if (!told) return;  // tried again
  told_readers_ = readers;
  told_writers_ = writers;
}

}  // namespace alidade
