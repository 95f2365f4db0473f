// When the messages of a topic were taken: by their headers, read as they are asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

class TopicStamps {
 public:
  // `bag` must outlive it.
  TopicStamps(BagFile& bag, size_t topic);

  size_t size() const { return messages_->size(); }
  const BagMessage& message(size_t i) const { return (*messages_)[i]; }
  // Nanoseconds. Of a message without a stamp, or one that cannot be read: when it was written
  // down, less what lies between the two in this topic.
  int64_t Stamp(size_t i);
  // When it was written down, on the clock of the stamps: nothing is read for it.
  int64_t Expected(size_t i) const;
  // Frames a second by when they were written down, a whole number where it is near one; nothing
  // for less than two.
  std::optional<double> Rate() const;

 private:
  int64_t HeaderStamp(size_t i);  // 0: none

  BagFile& bag_;
  Serialization serialization_;
  const std::vector<BagMessage>* messages_;
  std::vector<int64_t> stamps_;  // kUnread where nobody asked yet
  int64_t lag_ = 0;              // from stamps to log times, the middle one of the first few
};

// "1403715273.262142976"; six digits after the point where the other three are 0.
std::string StampText(int64_t nanoseconds);

// Pairs frames with what was taken at the same time. Of the frames around one and the messages
// around it, each belongs to the nearest in time, one to one, as for recordings in folders
// (io/association.h); only what lies near is read.
class PartnerFinder {
 public:
  PartnerFinder(TopicStamps& frames, TopicStamps& partners, double max_dt)
      : frames_(frames), partners_(partners), max_dt_(max_dt) {}
  std::optional<size_t> PartnerOf(size_t frame);

 private:
  TopicStamps& frames_;
  TopicStamps& partners_;
  double max_dt_;  // seconds
};

}  // namespace alidade
