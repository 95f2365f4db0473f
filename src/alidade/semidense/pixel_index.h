// Finds edge pixels by position: one bit per image pixel, and for each word of 32 pixels the number
// of edge pixels before it. A quarter byte per pixel, so that several images stay in the cache.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "alidade/semidense/gradient_image.h"

namespace alidade {

class PixelIndex {
 public:
  PixelIndex(int width, int height)
      : row_((static_cast<uint32_t>(width) + kBits - 1) / kBits),
        words_(static_cast<size_t>(row_) * height) {}

  // Appends a pixel; they come by row, then column. Call Finish() after the last.
  void Append(const EdgePixel& pixel) {
    words_[pixel.y * row_ + pixel.x / kBits].bits |= 1u << (pixel.x % kBits);
  }
  void Finish() {
    uint32_t count = 0;
    for (Word& word : words_) {
      word.before = count;
      count += static_cast<uint32_t>(std::popcount(word.bits));
    }
  }

  // Pixels side by side: bit k is set if the k-th was appended. The first of those that were has
  // the index `first` among all, the next one `first` + 1, and so on.
  struct Run {
    uint32_t bits, first;
  };
  // Of `count` pixels from (x, y) to the right, all in the image; at most 31.
  Run At(uint32_t x, uint32_t y, uint32_t count) const {
    const Word* word = &words_[y * row_ + x / kBits];
    const uint32_t shift = x % kBits;
    uint32_t bits = word->bits >> shift;
    if (shift + count > kBits) bits |= word[1].bits << (kBits - shift);
    const uint32_t below = word->bits & ((1u << shift) - 1);
    return {bits & ((1u << count) - 1), word->before + static_cast<uint32_t>(std::popcount(below))};
  }

 private:
  static constexpr uint32_t kBits = 32;
  struct Word {
    uint32_t bits = 0, before = 0;
  };
  uint32_t row_;  // words per row
  std::vector<Word> words_;
};

}  // namespace alidade
