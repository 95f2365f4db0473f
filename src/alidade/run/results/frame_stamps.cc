#include "alidade/run/results/frame_stamps.h"

#include <cstdlib>

namespace alidade {

void FrameStamps::Add(FrameStamp frame) {
  if (empty()) first_number_ = frame.number;
  if (open_.size() == kChunk) Seal();
  open_.push_back(std::move(frame));
}

// As text: number, space, stamp, zero byte.
void FrameStamps::Seal() {
  Chunk chunk;
  for (const FrameStamp& frame : open_) {
    chunk.text += std::to_string(frame.number) + " " + frame.stamp;
    chunk.text += '\0';
  }
  chunk.size = chunk.text.size();
  if (store_) chunk.stored = store_->Put(chunk.text);
  if (chunk.stored) chunk.text = std::string();
  chunk.text.shrink_to_fit();
  full_.push_back(std::move(chunk));
  open_.clear();
}

const FrameStamp& FrameStamps::Reader::At(size_t i) {
  const size_t number = i / kChunk;
  if (number >= all_.full_.size()) return all_.open_[i % kChunk];
  if (std::exchange(chunk_, number) == number) return frames_[i % kChunk];
  const Chunk& chunk = all_.full_[number];
  std::string text = chunk.text;
  if (chunk.stored) {
    text.resize(chunk.size);
    chunk.stored->Read(text);
  }
  frames_.clear();
  for (size_t at = 0; at < text.size();) {
    char* stamp = nullptr;
    const long frame = std::strtol(&text[at], &stamp, 10);
    frames_.push_back({stamp + 1, static_cast<int>(frame)});
    at = static_cast<size_t>(stamp - text.data()) + 1 + frames_.back().stamp.size() + 1;
  }
  return frames_[i % kChunk];
}

}  // namespace alidade
