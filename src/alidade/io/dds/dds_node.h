// DdsNode by Eclipse Cyclone DDS.
#pragma once

#include <dds/dds.h>

#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "alidade/io/dds/dds_module.h"

namespace alidade {

// Closes a DDS entity, and all that were created under it.
class DdsEntity {
 public:
  DdsEntity() = default;
  explicit DdsEntity(dds_entity_t handle) : handle_(handle) {}
  ~DdsEntity() { Close(); }
  DdsEntity(DdsEntity&& other) noexcept : handle_(other.handle_) { other.handle_ = 0; }
  DdsEntity& operator=(DdsEntity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  dds_entity_t get() const { return handle_; }
  bool valid() const { return handle_ > 0; }
  void Close() {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = 0;
  }

 private:
  dds_entity_t handle_ = 0;
};

class CycloneNode : public DdsNode {
 public:
  explicit CycloneNode(const DdsDomain& domain);  // throws std::runtime_error
  ~CycloneNode() override;

  std::vector<DdsPublication> Publications() override;
  int Subscribe(const std::string& topic, const std::string& type, DdsQuality quality, int depth,
                std::string* problem) override;
  void Unsubscribe(int subscription) override;
  std::vector<DdsMessage> Take(double seconds) override;
  void Wake() override;
  int Advertise(const std::string& topic, const std::string& type, DdsQuality quality,
                std::string* problem) override;
  bool Publish(int publication, std::string_view bytes) override;
  int Listeners(int publication) override;
  std::vector<std::string> News() override;

 private:
  struct Endpoint {
    std::string topic;
    DdsEntity entity;     // reader or writer
    DdsEntity condition;  // of a reader: it has messages
    const dds_topic_descriptor_t* type = nullptr;
    uint32_t unmatched = 0;  // of others, for their quality of service, told so far
  };
  // Throws std::runtime_error.
  Endpoint Create(const std::string& topic, const std::string& type, DdsQuality quality, int depth,
                  bool reader);
  void TakeFrom(int number, Endpoint& reader, std::vector<DdsMessage>& messages);

  DdsEntity domain_, participant_, waitset_, wake_, discovery_;
  std::mutex mutex_;  // guards the members below
  std::map<int, Endpoint> readers_, writers_;
  std::map<std::string, DdsEntity> topics_;
  int next_ = 0;  // number of the next subscription or publication
};

}  // namespace alidade
