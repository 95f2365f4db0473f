// Order of a topic's messages by header time, for recorders that swap neighbors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "alidade/io/ros/source/topic_stamps.h"

namespace alidade {

// Reads only the headers around a place, so that playing can begin anywhere. Messages are sorted in
// groups: between two groups, none of the 8 messages before is stamped after one of the 8 messages
// behind. Left in the order of recording: a group of more than 32 messages, and one with a step
// back of more than a second, which is a damaged stamp or another recording (as in lists,
// io/files/datasets/list_order.h).
class PlayOrder {
 public:
  explicit PlayOrder(TopicStamps& stamps) : stamps_(stamps) {}
  // Index of the message to play in this place; each message has one place.
  size_t At(size_t place);

 private:
  // What message a, recorded before b, is stamped later than b, nanoseconds; at least 0.
  int64_t StepBack(size_t a, size_t b);
  bool BeginsGroup(size_t i);
  void Sort(size_t first, size_t end);

  TopicStamps& stamps_;
  size_t first_ = 0;           // of the group that was sorted last
  std::vector<size_t> order_;  // its messages in order of time
};

}  // namespace alidade
