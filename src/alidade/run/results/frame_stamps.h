// Time stamps and numbers of the frames of a run, as the recording has them.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/byte_store.h"

namespace alidade {

struct FrameStamp {
  std::string stamp;  // SourceFrame::stamp
  int number = 0;     // SourceFrame::number
};

// Stored in chunks of 512. All but the last are text, in the ByteStore or else in memory (some 25
// bytes per frame). One thread at a time.
class FrameStamps {
 public:
  // Chunks that fill up from now on go there.
  void KeepIn(std::shared_ptr<ByteStore> store) { store_ = std::move(store); }

  void Add(FrameStamp frame);
  void TakeBack() { open_.pop_back(); }               // the frame added last, once
  int first_number() const { return first_number_; }  // of the first frame
  size_t size() const { return kChunk * full_.size() + open_.size(); }
  bool empty() const { return size() == 0; }

  // Reads frames by their index, fast in ascending order. The stamps must outlive it and not
  // change.
  class Reader {
   public:
    explicit Reader(const FrameStamps& all) : all_(all) {}
    // Requires i < size(). Throws Error (input) if the ByteStore cannot be read.
    const FrameStamp& At(size_t i);

   private:
    const FrameStamps& all_;
    size_t chunk_ = SIZE_MAX;  // the one in frames_
    std::vector<FrameStamp> frames_;
  };

 private:
  static constexpr size_t kChunk = 512;
  struct Chunk {
    std::string text;  // in memory; empty: stored
    std::shared_ptr<const ByteStore::Piece> stored;
    size_t size = 0;  // bytes of the text
  };
  void Seal();

  std::shared_ptr<ByteStore> store_;
  int first_number_ = 0;
  std::vector<Chunk> full_;
  std::vector<FrameStamp> open_;
};

}  // namespace alidade
