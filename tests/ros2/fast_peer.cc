#include "ros2/fast_peer.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <map>
#include <stdexcept>
#include <utility>

namespace alidade {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr uint32_t kMostBytes = 8 << 20;  // of a message

// A type whose values are the bytes of messages.
class BytesType : public dds::TopicDataType {
 public:
  explicit BytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kMostBytes;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<std::string*>(data);
    payload->length = static_cast<uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data),
                                            payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<uint32_t>(static_cast<std::string*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

class Hearer : public dds::DataReaderListener {
 public:
  explicit Hearer(std::function<void(std::string)> heard) : heard_(std::move(heard)) {}
  void on_data_available(dds::DataReader* reader) override {
    std::string bytes;
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) heard_(std::move(bytes));
      bytes.clear();
    }
  }

 private:
  std::function<void(std::string)> heard_;
};

template <typename Qos>
void SetQuality(Qos& qos, FastPeer::Quality quality) {
  qos.reliability().kind = quality == FastPeer::Quality::kBestEffort
                               ? dds::BEST_EFFORT_RELIABILITY_QOS
                               : dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = quality == FastPeer::Quality::kLatched
                              ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                              : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 10;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

}  // namespace

struct FastPeer::Impl {
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  std::map<std::string, dds::Topic*> topics;
  std::vector<dds::DataWriter*> writers;
  std::vector<std::unique_ptr<dds::DataReaderListener>> hearers;

  dds::Topic* TopicOf(const std::string& name, const std::string& type) {
    dds::Topic*& topic = topics[name];
    if (topic != nullptr) return topic;
    dds::TypeSupport(new BytesType(type)).register_type(participant);
    topic = participant->create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
    if (topic == nullptr) throw std::runtime_error("Fast DDS has no topic " + name);
    return topic;
  }
};

FastPeer::FastPeer(int domain) : impl_(std::make_unique<Impl>()) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  // By UDP on loopback, as between machines; not by memory that Fast DDS shares with itself.
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  udp->sendBufferSize = udp->receiveBufferSize = 4 << 20;
  qos.transport().user_transports = {udp};
  qos.transport().use_builtin_transports = false;
  impl_->participant = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<uint32_t>(domain), qos);
  if (impl_->participant == nullptr) throw std::runtime_error("Fast DDS joins no domain");
  impl_->publisher = impl_->participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  impl_->subscriber = impl_->participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
}

FastPeer::~FastPeer() {
  impl_->participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(impl_->participant);
}

int FastPeer::Advertise(const std::string& topic, const std::string& type, Quality quality,
                        const std::string& user_data) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  SetQuality(qos, quality);
  qos.user_data().assign(user_data.begin(), user_data.end());
  qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;  // messages larger than a datagram
  dds::DataWriter* writer = impl_->publisher->create_datawriter(impl_->TopicOf(topic, type), qos);
  if (writer == nullptr) throw std::runtime_error("Fast DDS does not publish " + topic);
  impl_->writers.push_back(writer);
  return static_cast<int>(impl_->writers.size()) - 1;
}

void FastPeer::Publish(int publication, const std::string& bytes) {
  impl_->writers.at(static_cast<size_t>(publication))->write(const_cast<std::string*>(&bytes));
}

int FastPeer::Listeners(int publication) {
  dds::PublicationMatchedStatus status;
  impl_->writers.at(static_cast<size_t>(publication))->get_publication_matched_status(status);
  return status.current_count;
}

void FastPeer::Subscribe(const std::string& topic, const std::string& type, Quality quality,
                         std::function<void(std::string bytes)> heard) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  SetQuality(qos, quality);
  impl_->hearers.push_back(std::make_unique<Hearer>(std::move(heard)));
  if (impl_->subscriber->create_datareader(impl_->TopicOf(topic, type), qos,
                                           impl_->hearers.back().get()) == nullptr)
    throw std::runtime_error("Fast DDS does not hear " + topic);
}

}  // namespace alidade
