// Header times of a topic's messages, read on demand.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

class TopicStamps {
 public:
  // `bag` must outlive this object.
  TopicStamps(BagFile& bag, size_t topic);

  size_t size() const { return messages_->size(); }
  const BagMessage& message(size_t i) const { return (*messages_)[i]; }
  // Header time of message i, nanoseconds. When the header cannot be read or has no stamp:
  // Expected(i).
  int64_t Stamp(size_t i);
  // Log time of message i minus the topic's typical delay, nanoseconds. Does not read the message.
  int64_t Expected(size_t i) const;
  // Frames per second, from the log times, rounded to a whole number if it is close to one; nullopt
  // for fewer than two messages.
  std::optional<double> Rate() const;

 private:
  int64_t HeaderStamp(size_t i);  // 0: no stamp

  BagFile& bag_;
  Serialization serialization_;
  bool video_;  // messages of kVideoType, whose header is another
  const std::vector<BagMessage>* messages_;
  std::vector<int64_t> stamps_;  // kUnread until read
  // Nanoseconds from header times to log times, the median of the first few messages.
  int64_t lag_ = 0;
};

// "1403715273.262142976"; 6 decimals when the last three digits are 0.
std::string StampText(int64_t nanoseconds);

// Seconds, more than half a frame interval at 30 Hz; the default of TUM's associate.py.
inline constexpr double kDepthWithin = 0.02;
// Seconds. The drivers of cameras that are triggered together may stamp them slightly apart.
// Rotating at 60 degrees per second, the image moves by about 2 pixels in this time.
inline constexpr double kPairWithin = 0.003;

// Pairs frames with messages of another topic taken at the same time. Associates the frames around
// the given one with the messages around it, as for recordings in folders (io/association.h), and
// reads only these messages' headers.
class PartnerFinder {
 public:
  PartnerFinder(TopicStamps& frames, TopicStamps& partners, double max_dt)
      : frames_(frames), partners_(partners), max_dt_(max_dt) {}
  std::optional<size_t> PartnerOf(size_t frame);

 private:
  TopicStamps& frames_;
  TopicStamps& partners_;
  double max_dt_;  // largest time difference, seconds
};

}  // namespace alidade
