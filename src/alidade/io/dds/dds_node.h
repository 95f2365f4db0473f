// DdsNode by Eclipse Cyclone DDS.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/dds/dds_entity.h"
#include "alidade/io/dds/dds_module.h"
#include "alidade/io/dds/node_introduction.h"

namespace alidade {

class CycloneNode : public DdsNode {
 public:
  // Throws std::runtime_error.
  CycloneNode(const DdsDomain& domain, const std::string& name);
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
  // Calls visit(endpoint) for each known publication of another participant.
  template <typename Visit>
  void ForEachPublication(Visit&& visit);
  void Introduce();  // requires mutex_
  void TakeFrom(int number, Endpoint& reader, std::vector<DdsMessage>& messages);

  DdsEntity domain_, participant_, waitset_, wake_, discovery_;
  std::mutex mutex_;  // guards the members below
  std::map<int, Endpoint> readers_, writers_;
  std::map<std::string, DdsEntity> topics_;
  std::optional<NodeIntroduction> introduction_;
  int next_ = 0;  // number of the next subscription or publication
};

}  // namespace alidade
