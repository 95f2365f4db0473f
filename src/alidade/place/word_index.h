// Keyframes by their words: which show what a frame shows, for one vocabulary.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/place/vocabulary.h"

namespace alidade {

struct PlaceMatch {
  KeyFrameId id;
  double score = 0;  // 0…1, the more the more alike
};

// One writer or many readers at a time. What it answers depends on the vocabulary and on which
// keyframes are in, not on the order they came in.
class WordIndex {
 public:
  explicit WordIndex(Vocabulary vocabulary);

  // How often each word of a frame occurs in it, sorted by word.
  struct WordCount {
    uint32_t word = 0;
    uint32_t count = 0;
  };
  using Bag = std::vector<WordCount>;
  Bag BagOf(const Frame& frame) const;

  void Insert(KeyFrameId id, std::shared_ptr<const Frame> frame, Bag bag);  // id must not be in
  void Erase(KeyFrameId id);
  bool Has(KeyFrameId id) const { return slots_.count(id) > 0; }
  int size() const { return static_cast<int>(slots_.size()); }
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Frame>>> KeyFrames() const;  // by id

  std::vector<PlaceMatch> Query(const Frame& frame, const std::function<bool(KeyFrameId)>& may_be,
                                size_t most) const;
  double Score(const Frame& frame, KeyFrameId id) const;

  const Vocabulary& vocabulary() const { return vocabulary_; }
  size_t MemoryBytes() const;

 private:
  struct Entry {
    KeyFrameId id;
    std::shared_ptr<const Frame> frame;
    Bag bag;
  };
  struct Posting {
    uint32_t slot = 0;
    uint32_t count = 0;
  };
  double Weight(uint32_t word) const;  // inverse document frequency

  Vocabulary vocabulary_;
  std::vector<Entry> entries_;  // by slot; a free one has no frame
  std::vector<uint32_t> free_;
  std::map<KeyFrameId, uint32_t> slots_;
  std::vector<std::vector<Posting>> postings_;  // of each word
};

}  // namespace alidade
