// Finds the keyframes that show the place a frame shows. Its vocabulary is learnt from the
// keyframes themselves: no file, nothing to load, ready with the first of them.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/place/settings.h"
#include "alidade/place/vocabulary.h"
#include "alidade/place/word_index.h"

namespace ALIDADE_API alidade {

// What a saved map keeps: words are found anew on load.
struct SavedPlaces {
  std::vector<Vocabulary::Node> nodes;
  uint32_t grown_at = 0;  // keyframes there were when the vocabulary was grown; 0: never
};

// May be asked from one thread while another adds. The same keyframes added and removed in the same
// order give the same answers, on any machine and after any restoring.
class PlaceIndex {
 public:
  explicit PlaceIndex(PlaceSettings settings = {}, uint64_t seed = 1);

  // An id that is in already is replaced. When keyframes have doubled since the vocabulary was
  // grown, it is grown anew: tens of milliseconds, in which queries go on with the old one.
  void Add(KeyFrameId id, std::shared_ptr<const Frame> frame);
  void Remove(KeyFrameId id);

  // The `most` likest of the keyframes that `may_be` (empty: all) lets pass; best first, ties by
  // id. `may_be` must not call back into the index.
  std::vector<PlaceMatch> Query(const Frame& frame, const std::function<bool(KeyFrameId)>& may_be,
                                size_t most) const;
  // The same score for the keyframes named; 0 for one that is not in.
  std::vector<double> Scores(const Frame& frame, std::span<const KeyFrameId> ids) const;
  double Score(const Frame& frame, KeyFrameId id) const { return Scores(frame, {&id, 1})[0]; }
  int size() const;

  SavedPlaces Save() const;
  // Replaces all there was. Throws Error (input) on nodes that make no vocabulary, leaving the
  // index as it was.
  void Restore(const SavedPlaces& saved, const std::vector<PlaceKeyFrame>& keyframes);

  size_t MemoryBytes() const;  // of words and index, the frames' own descriptors apart

 private:
  void GrowWhenDoubled();
  std::unique_ptr<WordIndex> Grown() const;

  PlaceSettings settings_;
  uint64_t seed_ = 1;
  std::mutex writer_;                  // held by whoever changes the index, from start to end
  mutable std::shared_mutex content_;  // of what follows: held by the writer while it changes it
  std::unique_ptr<WordIndex> index_;
  uint32_t grown_at_ = 0;
};

}  // namespace alidade
