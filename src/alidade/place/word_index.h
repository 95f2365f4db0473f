// Inverted index: keyframes by their words, for one vocabulary.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/place/settings.h"
#include "alidade/place/vocabulary.h"
#include "alidade/place/word_matching.h"

namespace ALIDADE_API alidade {

struct PlaceMatch {
  KeyFrameId id;
  double score = 0;  // matches / geometric mean of both keypoint counts, 0 to 1
};

using PlaceKeyFrame = std::pair<KeyFrameId, std::shared_ptr<const Frame>>;

// Not synchronized: one writer or several readers at a time. Results depend on the vocabulary and
// the set of keyframes, not on the order of insertion.
class WordIndex {
 public:
  WordIndex(Vocabulary vocabulary, const PlaceSettings& settings);

  // `words`: WordsOf(*frame, vocabulary()). The id must not be present yet.
  void Insert(KeyFrameId id, std::shared_ptr<const Frame> frame,
              const std::vector<KeypointWord>& words);
  void Erase(KeyFrameId id);
  bool Has(KeyFrameId id) const { return slots_.count(id) > 0; }
  int size() const { return static_cast<int>(slots_.size()); }
  std::vector<PlaceKeyFrame> KeyFrames() const;  // by id

  // See PlaceIndex.
  std::vector<PlaceMatch> Query(const Frame& frame, const std::function<bool(KeyFrameId)>& may_be,
                                size_t most) const;
  std::vector<double> Scores(const Frame& frame, std::span<const KeyFrameId> ids) const;

  const Vocabulary& vocabulary() const { return vocabulary_; }
  size_t MemoryBytes() const;

 private:
  struct Entry {
    KeyFrameId id;
    std::shared_ptr<const Frame> frame;
    std::vector<KeypointWord> groups;  // group of each word, for matching
  };
  struct Posting {  // kept small: a query reads about 200 per keyframe
    uint32_t slot : 24;
    uint32_t count : 8;  // keypoints with the word, at most 255
  };
  std::vector<PlaceMatch> Shortlist(const std::vector<KeypointWord>& words,
                                    const std::function<bool(KeyFrameId)>& may_be,
                                    size_t most) const;
  double Score(const Frame& frame, const std::vector<KeypointWord>& groups,
               const Entry& entry) const;

  Vocabulary vocabulary_;
  PlaceSettings settings_;
  std::vector<uint32_t> groups_;  // of each word
  std::vector<Entry> entries_;    // by slot; a free slot has no frame
  std::vector<uint32_t> free_;
  std::map<KeyFrameId, uint32_t> slots_;
  std::vector<std::vector<Posting>> postings_;  // by word
};

}  // namespace alidade
