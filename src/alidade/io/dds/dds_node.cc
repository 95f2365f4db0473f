#include "alidade/io/dds/dds_node.h"

#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include "alidade/io/dds/type_table.h"

namespace alidade {
namespace {

constexpr int kLatchedDepth =
    100;  // messages that late subscribers get: each static transform may be one
constexpr dds_duration_t kBlocked =
    DDS_MSECS(100);  // a reliable writer waits this long for a slow reader

// Discovery and data over loopback, which has no multicast by itself.
constexpr char kLoopback[] =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\" "
    "multicast=\"true\"/></Interfaces></General></Domain></CycloneDDS>";
// A receive buffer that holds some images: the kernel gives at most net.core.rmem_max.
constexpr char kBuffers[] =
    "<CycloneDDS><Domain><Internal><SocketReceiveBufferSize "
    "max=\"10MB\"/></Internal></Domain></CycloneDDS>";

Qos QosOf(DdsQuality quality, int depth) {
  Qos qos(dds_create_qos());
  const bool reliable = quality != DdsQuality::kSensor, latched = quality == DdsQuality::kLatched;
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kBlocked);
  dds_qset_durability(qos.get(),
                      latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST,
                   latched ? std::max(depth, kLatchedDepth) : depth);
  if (latched)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, kLatchedDepth,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  const dds_data_representation_id_t plain_cdr = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &plain_cdr);
  return qos;
}

DdsQuality QualityOf(const dds_qos_t* qos) {
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_duration_t blocked = 0;
  dds_qget_reliability(qos, &reliability, &blocked);
  dds_qget_durability(qos, &durability);
  if (reliability == DDS_RELIABILITY_BEST_EFFORT) return DdsQuality::kSensor;
  return durability == DDS_DURABILITY_VOLATILE ? DdsQuality::kReliable : DdsQuality::kLatched;
}

std::string NameOfPolicy(uint32_t id) {
  switch (id) {
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability";
    case DDS_DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case DDS_LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
      return "data representation";
    default:
      return "quality of service (policy " + std::to_string(id) + ")";
  }
}

constexpr size_t kCdrHeader = 4;  // bytes

struct FreeSample {
  const dds_topic_descriptor_t* type = nullptr;
  void operator()(void* sample) const { dds_sample_free(sample, type, DDS_FREE_ALL); }
};

// The C value of a message, allocated by Cyclone; null if the bytes are not little-endian CDR of
// that type.
void* SampleOf(std::string_view bytes, const dds_topic_descriptor_t& type) {
  if (bytes.size() < kCdrHeader || bytes.substr(0, 2) != std::string_view("\0\1", 2))
    return nullptr;
  // Numbers are aligned to their size from the end of the header.
  std::vector<uint64_t> aligned((bytes.size() - kCdrHeader + 7) / 8);
  auto* data = reinterpret_cast<char*>(aligned.data());
  std::memcpy(data, bytes.data() + kCdrHeader, bytes.size() - kCdrHeader);
  const auto size = static_cast<uint32_t>(bytes.size() - kCdrHeader);
  uint32_t used = 0;
  if (!dds_stream_normalize_data(data, &used, size, false, CDR_ENC_VERSION_1, type.m_ops))
    return nullptr;
  dds_istream_t stream;
  dds_istream_init(&stream, size, data, CDR_ENC_VERSION_1);
  void* sample = dds_alloc(type.m_size);
  std::memset(sample, 0, type.m_size);
  dds_stream_read(&stream, static_cast<char*>(sample), type.m_ops);
  dds_istream_fini(&stream);
  return sample;
}

}  // namespace

CycloneNode::CycloneNode(const DdsDomain& domain, const std::string& name) {
  const auto id = static_cast<dds_domainid_t>(domain.id);
  std::string config = kBuffers;
  if (domain.local_only) config += std::string(",") + kLoopback;
  // The user's settings come last, so that they count.
  if (const char* own = std::getenv("CYCLONEDDS_URI"); own != nullptr && *own != '\0')
    config += std::string(",") + own;
  const dds_entity_t made = dds_create_domain(id, config.c_str());
  // A second participant of this process finds the domain there.
  if (made != DDS_RETCODE_PRECONDITION_NOT_MET) domain_ = Checked(made, "the domain");
  const Qos of_participant(dds_create_qos());
  SetParticipantData(of_participant.get());
  participant_ =
      Checked(dds_create_participant(id, of_participant.get(), nullptr), "the participant");
  waitset_ = Checked(dds_create_waitset(participant_.get()), "the waitset");
  wake_ = Checked(dds_create_guardcondition(participant_.get()), "the waitset");
  dds_waitset_attach(waitset_.get(), wake_.get(), 0);
  discovery_ = Checked(
      dds_create_reader(participant_.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
      "discovery");
  introduction_.emplace(participant_.get(), name);
}

CycloneNode::~CycloneNode() {
  introduction_.reset();
  readers_.clear();
  writers_.clear();
  topics_.clear();
  for (DdsEntity* entity : {&discovery_, &wake_, &waitset_, &participant_, &domain_})
    entity->Close();
}

template <typename Visit>
void CycloneNode::ForEachPublication(Visit&& visit) {
  constexpr uint32_t kMost = 1000;
  std::vector<void*> samples(kMost, nullptr);
  std::vector<dds_sample_info_t> infos(kMost);
  const dds_return_t count = dds_read(discovery_.get(), samples.data(), infos.data(), kMost, kMost);
  dds_guid_t own{};
  dds_get_guid(participant_.get(), &own);
  for (dds_return_t i = 0; i < count; ++i) {
    const auto n = static_cast<size_t>(i);
    if (!infos[n].valid_data || infos[n].instance_state != DDS_IST_ALIVE) continue;
    const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[n]);
    if (std::equal(std::begin(own.v), std::end(own.v), std::begin(endpoint->participant_key.v)))
      continue;
    visit(*endpoint);
  }
  if (count > 0) dds_return_loan(discovery_.get(), samples.data(), count);
}

std::vector<DdsPublication> CycloneNode::Publications() {
  std::vector<DdsPublication> all;
  ForEachPublication([&](const dds_builtintopic_endpoint_t& endpoint) {
    DdsPublication publication{RosTopicOf(endpoint.topic_name), RosTypeOf(endpoint.type_name),
                               QualityOf(endpoint.qos)};
    if (!publication.topic.empty() && !publication.type.empty())
      all.push_back(std::move(publication));
  });
  return all;
}

void CycloneNode::Introduce() {
  if (!introduction_->IsDue()) return;
  NodesSeen seen;
  ForEachPublication([&](const dds_builtintopic_endpoint_t& endpoint) {
    seen.ros = seen.ros || IsIntroductionOfRos(endpoint.topic_name, endpoint.qos);
    seen.hashes = seen.hashes || TellsTypeHash(endpoint.qos);
  });
  std::vector<dds_entity_t> readers, writers;
  for (const auto& [number, reader] : readers_) readers.push_back(reader.entity.get());
  for (const auto& [number, writer] : writers_) writers.push_back(writer.entity.get());
  introduction_->Tell(seen, readers, writers);
}

CycloneNode::Endpoint CycloneNode::Create(const std::string& topic, const std::string& type,
                                          DdsQuality quality, int depth, bool reader) {
  const dds_topic_descriptor_t* descriptor = DescriptorOf(type);
  if (descriptor == nullptr) throw std::runtime_error("messages of type " + type + " are unknown");
  DdsEntity& described = topics_[topic + " " + type];
  if (!described.valid())
    described = Checked(dds_create_topic(participant_.get(), descriptor, DdsTopicOf(topic).c_str(),
                                         nullptr, nullptr),
                        topic.c_str());
  const Qos qos = QosOf(quality, depth);
  Endpoint endpoint;
  endpoint.topic = topic;
  endpoint.entity =
      Checked(reader ? dds_create_reader(participant_.get(), described.get(), qos.get(), nullptr)
                     : dds_create_writer(participant_.get(), described.get(), qos.get(), nullptr),
              topic.c_str());
  endpoint.type = descriptor;
  return endpoint;
}

int CycloneNode::Subscribe(const std::string& topic, const std::string& type, DdsQuality quality,
                           int depth, std::string* problem) try {
  const std::lock_guard<std::mutex> lock(mutex_);
  Endpoint reader = Create(topic, type, quality, depth, true);
  reader.condition =
      Checked(dds_create_readcondition(reader.entity.get(), DDS_ANY_STATE), topic.c_str());
  const int number = next_++;
  dds_waitset_attach(waitset_.get(), reader.condition.get(), number);
  readers_.emplace(number, std::move(reader));
  return number;
} catch (const std::runtime_error& error) {
  *problem = error.what();
  return -1;
}

void CycloneNode::Unsubscribe(int subscription) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto reader = readers_.find(subscription);
  if (reader == readers_.end()) return;
  dds_waitset_detach(waitset_.get(), reader->second.condition.get());
  readers_.erase(reader);
}

void CycloneNode::TakeFrom(int number, Endpoint& reader, std::vector<DdsMessage>& messages) {
  constexpr size_t kAtOnce = 16;
  while (true) {
    std::array<struct ddsi_serdata*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos{};
    const dds_return_t count =
        dds_takecdr(reader.entity.get(), samples.data(), kAtOnce, infos.data(), DDS_ANY_STATE);
    for (size_t i = 0; i < static_cast<size_t>(std::max(count, 0)); ++i) {
      if (infos[i].valid_data) {
        DdsMessage message;
        message.subscription = number;
        message.sent = infos[i].source_timestamp;
        message.bytes.resize(ddsi_serdata_size(samples[i]));
        ddsi_serdata_to_ser(samples[i], 0, message.bytes.size(), message.bytes.data());
        messages.push_back(std::move(message));
      }
      ddsi_serdata_unref(samples[i]);
    }
    if (count < static_cast<dds_return_t>(kAtOnce)) return;
  }
}

std::vector<DdsMessage> CycloneNode::Take(double seconds) {
  std::vector<DdsMessage> messages;
  dds_attach_t triggered = 0;
  dds_waitset_wait(waitset_.get(), &triggered, 1, static_cast<dds_duration_t>(1e9 * seconds));
  const std::lock_guard<std::mutex> lock(mutex_);
  bool woken = false;
  dds_take_guardcondition(wake_.get(), &woken);
  Introduce();
  for (auto& [number, reader] : readers_) TakeFrom(number, reader, messages);
  return messages;
}

void CycloneNode::Wake() { dds_set_guardcondition(wake_.get(), true); }

int CycloneNode::Advertise(const std::string& topic, const std::string& type, DdsQuality quality,
                           std::string* problem) try {
  constexpr int kDepth = 10;
  const std::lock_guard<std::mutex> lock(mutex_);
  Endpoint writer = Create(topic, type, quality, kDepth, false);
  const int number = next_++;
  writers_.emplace(number, std::move(writer));
  return number;
} catch (const std::runtime_error& error) {
  *problem = error.what();
  return -1;
}

bool CycloneNode::Publish(int publication, std::string_view bytes) {
  dds_entity_t writer = 0;
  const dds_topic_descriptor_t* type = nullptr;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = writers_.find(publication);
    if (found == writers_.end()) return false;
    writer = found->second.entity.get();
    type = found->second.type;
  }
  // Without the lock: writing a cloud may wait for a slow reader, while transforms are written.
  const std::unique_ptr<void, FreeSample> sample(SampleOf(bytes, *type), FreeSample{type});
  return sample != nullptr && dds_write(writer, sample.get()) == DDS_RETCODE_OK;
}

int CycloneNode::Listeners(int publication) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto writer = writers_.find(publication);
  if (writer == writers_.end()) return 0;
  dds_publication_matched_status_t status{};
  if (dds_get_publication_matched_status(writer->second.entity.get(), &status) < 0) return 0;
  return static_cast<int>(status.current_count);
}

std::vector<std::string> CycloneNode::News() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> news;
  for (auto& [number, reader] : readers_) {
    dds_requested_incompatible_qos_status_t status{};
    if (dds_get_requested_incompatible_qos_status(reader.entity.get(), &status) < 0) continue;
    if (std::exchange(reader.unmatched, status.total_count) == status.total_count) continue;
    news.push_back(reader.topic + ": a publisher's " + NameOfPolicy(status.last_policy_id) +
                   " does not match; its messages do not arrive");
  }
  for (auto& [number, writer] : writers_) {
    dds_offered_incompatible_qos_status_t status{};
    if (dds_get_offered_incompatible_qos_status(writer.entity.get(), &status) < 0) continue;
    if (std::exchange(writer.unmatched, status.total_count) == status.total_count) continue;
    news.push_back(writer.topic + ": a subscriber asks for another " +
                   NameOfPolicy(status.last_policy_id) + "; it gets no messages");
  }
  return news;
}

}  // namespace alidade
