// The chunks unpacked last: messages that follow each other are mostly of one chunk.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>

namespace alidade {

class ChunkCache {
 public:
  // The chunk at `place`, by `unpack` when it is not known any more. What `unpack` throws is not
  // remembered.
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
  // Bytes: half a second of two colour cameras, 640 x 480 at 30 Hz, which is how far a partner in
  // time is looked for.
  static constexpr size_t kMostHeld = size_t{1} << 26;
  struct Chunk {
    uint64_t place;
    std::string bytes;
  };
  std::list<Chunk> chunks_;  // newest first
  size_t held_ = 0;
};

}  // namespace alidade
