#include "alidade/io/ros/source/topic_stamps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/association.h"
#include "alidade/io/ros/messages/messages.h"
#include "alidade/io/ros/messages/video_message.h"

namespace alidade {
namespace {

constexpr int64_t kUnread = std::numeric_limits<int64_t>::min();
constexpr uint64_t kHeaderBytes = 512;  // bytes; enough for a header with most frame_ids
constexpr size_t kLagMessages = 9;
// Nanoseconds: 0.5 s, the largest extra delay between header time and recording time. A window
// holds at most kMostInWindow messages, more than a camera sends in that time.
constexpr int64_t kWindow = 500'000'000;
constexpr size_t kMostInWindow = 256;

// Difference of untrusted times; 0 on overflow.
int64_t Difference(int64_t a, int64_t b) {
  int64_t difference = 0;
  return __builtin_sub_overflow(a, b, &difference) ? 0 : difference;
}

}  // namespace

TopicStamps::TopicStamps(BagFile& bag, size_t topic)
    : bag_(bag),
      serialization_(bag.Topics()[topic].serialization),
      video_(bag.Topics()[topic].type == kVideoType),
      messages_(&bag.Messages(topic)),
      stamps_(messages_->size(), kUnread) {
  std::vector<int64_t> lags;
  for (size_t i = 0; i < std::min(size(), kLagMessages); ++i) {
    const int64_t stamp = HeaderStamp(i);
    lags.push_back(stamp == 0 ? 0 : Difference(message(i).log_time, stamp));
  }
  if (lags.empty()) return;
  std::nth_element(lags.begin(), lags.begin() + static_cast<std::ptrdiff_t>(lags.size() / 2),
                   lags.end());
  lag_ = lags[lags.size() / 2];
}

int64_t TopicStamps::HeaderStamp(size_t i) {
  std::string bytes;
  for (const uint64_t most : {kHeaderBytes, BagFile::kWholeMessage}) {
    if (!bag_.Read(message(i), bytes, most).empty()) return 0;
    try {
      return video_ ? ParseVideoHeader(bytes, serialization_).stamp
                    : ParseRosHeader(bytes, serialization_).stamp;
    } catch (const Error&) {  // the header is longer than the bytes read, or damaged
      if (bytes.size() < most) return 0;
    }
  }
  return 0;
}

int64_t TopicStamps::Stamp(size_t i) {
  if (stamps_[i] == kUnread) {
    const int64_t stamp = HeaderStamp(i);
    stamps_[i] = stamp == 0 ? Expected(i) : stamp;
  }
  return stamps_[i];
}

int64_t TopicStamps::Expected(size_t i) const { return Difference(message(i).log_time, lag_); }

std::optional<double> TopicStamps::Rate() const {
  std::vector<int64_t> gaps;
  for (size_t i = 1; i < size(); ++i) {
    const int64_t gap = Difference(message(i).log_time, message(i - 1).log_time);
    if (gap > 0) gaps.push_back(gap);
  }
  if (gaps.empty()) return std::nullopt;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  const double rate = 1e9 / static_cast<double>(*middle);
  const double whole = std::round(rate);
  return whole >= 1 && std::abs(rate - whole) < 0.02 * whole ? whole : rate;
}

std::string StampText(int64_t nanoseconds) {
  const auto [seconds, rest] = std::div(static_cast<long>(nanoseconds), 1'000'000'000L);
  char text[48];
  const char* sign = nanoseconds < 0 ? "-" : "";
  if (rest % 1000 == 0) {
    std::snprintf(text, sizeof text, "%s%ld.%06ld", sign, std::labs(seconds),
                  std::labs(rest) / 1000);
  } else {
    std::snprintf(text, sizeof text, "%s%ld.%09ld", sign, std::labs(seconds), std::labs(rest));
  }
  return text;
}

namespace {

// Range [first, last) of the messages whose expected header time lies within the window around
// `time`.
std::pair<size_t, size_t> Around(const TopicStamps& topic, int64_t time) {
  size_t low = 0, high = topic.size();
  // Binary search for the first message expected at or after `time`; log times are sorted.
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (Difference(topic.Expected(middle), time) < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  size_t first = low, end = low;
  while (first > 0 && low - first < kMostInWindow &&
         Difference(time, topic.Expected(first - 1)) <= kWindow)
    --first;
  while (end < topic.size() && end - low < kMostInWindow &&
         Difference(topic.Expected(end), time) <= kWindow)
    ++end;
  return {first, end};
}

std::vector<double> SecondsAfter(TopicStamps& topic, std::pair<size_t, size_t> range,
                                 int64_t start) {
  std::vector<double> seconds;
  for (size_t i = range.first; i < range.second; ++i)
    seconds.push_back(1e-9 * static_cast<double>(Difference(topic.Stamp(i), start)));
  return seconds;
}

}  // namespace

std::optional<size_t> PartnerFinder::PartnerOf(size_t frame) {
  const int64_t stamp = frames_.Stamp(frame);
  // The range always includes the frame itself, even when it was recorded very late.
  std::pair<size_t, size_t> frames = Around(frames_, frames_.Expected(frame));
  frames.first = std::min(frames.first, frame);
  frames.second = std::max(frames.second, frame + 1);
  const std::pair<size_t, size_t> partners = Around(partners_, stamp);
  const auto pairs = AssociateByTime(SecondsAfter(frames_, frames, stamp),
                                     SecondsAfter(partners_, partners, stamp), max_dt_);
  for (const auto& [a, b] : pairs) {
    if (frames.first + static_cast<size_t>(a) == frame)
      return partners.first + static_cast<size_t>(b);
  }
  return std::nullopt;
}

}  // namespace alidade
