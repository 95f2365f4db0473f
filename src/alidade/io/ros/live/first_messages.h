// The first messages of all topics of a domain that may be of use, as a recording from which topics
// are chosen.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "alidade/io/dds/dds_module.h"
#include "alidade/io/ros/source/bag_file.h"

namespace alidade {

// One thread. Topics keep their indices; new ones are added at the end.
class FirstMessages : public BagFile {
 public:
  // `node` must outlive this object, which unsubscribes when it is destroyed. Image topics other
  // than those of the query are not subscribed to where it names them.
  FirstMessages(DdsNode& node, const BagQuery& query);
  ~FirstMessages() override;
  FirstMessages(const FirstMessages&) = delete;
  FirstMessages& operator=(const FirstMessages&) = delete;

  // Looks for new topics and waits for messages for at most `seconds`. Returns true if a topic had
  // its first message.
  bool Gather(double seconds);
  bool HasImages() const;    // whether any topic of images has a message
  std::string Seen() const;  // topics of images found so far, for users; empty: none

  const std::vector<BagTopic>& Topics() const override { return topics_; }
  const std::vector<BagMessage>& Messages(size_t topic) const override { return messages_[topic]; }
  std::string Read(const BagMessage& message, std::string& bytes, uint64_t most) override;
  const std::vector<std::string>& Warnings() const override { return warnings_; }

 private:
  bool Wanted(const std::string& topic, const std::string& type) const;
  void SubscribeToNew();

  DdsNode& node_;
  BagQuery query_;
  std::vector<BagTopic> topics_;
  std::vector<std::vector<BagMessage>> messages_;  // by topic
  std::vector<std::string> kept_;                  // bytes, by BagMessage::place
  std::map<int, size_t> subscribed_;               // topic of each subscription
  std::set<std::string> found_;                    // topics, with their types
  std::vector<std::string> warnings_;
};

}  // namespace alidade
