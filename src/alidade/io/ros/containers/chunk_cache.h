// Keeps the most recently used unpacked chunks, because consecutive messages are mostly in the same
// chunk.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>

namespace alidade {

class ChunkCache {
 public:
  // Returns the chunk at `place`; calls `unpack` when it is not cached. An exception of `unpack`
  // passes through and nothing is cached.
  const std::string& Get(uint64_t place, const std::function<std::string()>& unpack) {
    for (auto chunk = chunks_.begin(); chunk != chunks_.end(); ++chunk) {
      if (chunk->place != place) continue;
      chunks_.splice(chunks_.begin(), chunks_, chunk);
      return chunk->bytes;
    }
    chunks_.push_front({place, unpack()});
    held_ += chunks_.front().bytes.size();
    while (held_ > kMostHeld && chunks_.size() > 1) {
      held_ -= chunks_.back().bytes.size();
      chunks_.pop_back();
    }
    return chunks_.front().bytes;
  }

 private:
  // 64 MB: half a second of two color cameras of 640 x 480 at 30 Hz, the window in which a
  // message's partner in time is searched.
  static constexpr size_t kMostHeld = size_t{1} << 26;
  struct Chunk {
    uint64_t place;
    std::string bytes;
  };
  std::list<Chunk> chunks_;  // most recently used first
  size_t held_ = 0;
};

}  // namespace alidade
