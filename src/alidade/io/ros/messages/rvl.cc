#include "alidade/io/ros/messages/rvl.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"

namespace alidade {
namespace {

constexpr size_t kSizeBytes = 8;  // of width and height

uint32_t WordAt(std::string_view bytes, size_t at) {
  uint32_t word = 0;
  for (size_t i = 4; i-- > 0;) word = word << 8 | static_cast<uint8_t>(bytes[at + i]);
  return word;
}

// Reads the numbers of RVL. A number is a row of 4-bit groups, the lowest 3 bits first; the fourth
// bit says that another group follows. Eight groups are a 32-bit word, the first in its upper bits.
class RvlNumbers {
 public:
  explicit RvlNumbers(std::string_view bytes) : bytes_(bytes) {}

  uint32_t Next() {
    uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 3) {
      const uint32_t group = Group();
      value |= (group & 7) << shift;
      if ((group & 8) == 0) return value;
    }
    ThrowInput("is damaged: a number of its RVL data has no end");
  }

 private:
  uint32_t Group() {
    if (groups_ == 0) {
      if (bytes_.size() - at_ < 4) ThrowInput("is truncated: its RVL data ends early");
      word_ = WordAt(bytes_, at_);
      at_ += 4;
      groups_ = 8;
    }
    return word_ >> 4 * --groups_ & 15;
  }

  std::string_view bytes_;
  size_t at_ = 0;
  uint32_t word_ = 0;
  int groups_ = 0;  // of the word that are not yet read
};

}  // namespace

cv::Size RvlSize(std::string_view bytes) {
  if (bytes.size() < kSizeBytes) return {};
  const auto side = [&](size_t at) {
    return static_cast<int>(std::min<uint32_t>(WordAt(bytes, at), kMostSide + 1));
  };
  return {side(0), side(4)};
}

cv::Mat DecodeRvl(std::string_view bytes) {
  const cv::Size size = RvlSize(bytes);
  if (size.empty()) ThrowInput("is damaged: its RVL data states no size");
  if (!IsPictureSize(size.width, size.height))
    ThrowInput("cannot be used: " + TooLargeText(size.width, size.height));
  cv::Mat depth = cv::Mat::zeros(size, CV_16UC1);
  RvlNumbers numbers(bytes.substr(kSizeBytes));
  auto* pixel = depth.ptr<uint16_t>();
  size_t left = depth.total();
  const auto next_run = [&] {
    const uint32_t count = numbers.Next();
    if (count > left) ThrowInput("is damaged: its RVL data has more pixels than its size");
    left -= count;
    return count;
  };
  // Runs of zeros and of others in turn. The others are stored as differences d from the one
  // before, zeros left out: 0, -1, 1, -2, … as 0, 1, 2, 3, …
  uint32_t value = 0;
  while (left > 0) {
    const uint32_t zeros = next_run();
    pixel += zeros;
    if (left == 0) break;
    const uint32_t others = next_run();
    if (zeros == 0 && others == 0) ThrowInput("is damaged: its RVL data has an empty run");
    for (uint32_t i = 0; i < others; ++i) {
      const uint32_t stored = numbers.Next();
      value += stored >> 1 ^ (~(stored & 1) + 1);
      if (value > std::numeric_limits<uint16_t>::max())
        ThrowInput("is damaged: its RVL data exceeds 16 bits");
      *pixel++ = static_cast<uint16_t>(value);
    }
  }
  return depth;
}

}  // namespace alidade
