// Place recognition: finds the keyframes that show the same place as a frame. The vocabulary is
// trained on the keyframes themselves, so no vocabulary file is needed.
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

// The part of the index that a map file stores; the words of keyframes are recomputed on load.
struct SavedPlaces {
  std::vector<Vocabulary::Node> nodes;
  uint32_t grown_at = 0;  // number of keyframes when the vocabulary was grown; 0: never
};

// Thread-safe: queries may run while another thread adds or removes. The same sequence of additions
// and removals gives the same results on any machine, also after Restore().
class PlaceIndex {
 public:
  explicit PlaceIndex(PlaceSettings settings = {}, uint64_t seed = 1);

  // Adds or replaces a keyframe. When the number of keyframes has doubled since the vocabulary was
  // grown, regrows it, which takes tens of milliseconds; queries use the old one meanwhile.
  void Add(KeyFrameId id, std::shared_ptr<const Frame> frame);
  void Remove(KeyFrameId id);

  // Up to `most` keyframes with the highest scores among those accepted by `may_be` (empty: all);
  // best first, ties by id. `may_be` must not call the index.
  std::vector<PlaceMatch> Query(const Frame& frame, const std::function<bool(KeyFrameId)>& may_be,
                                size_t most) const;
  // The score of each given keyframe; 0 if it is not in the index.
  std::vector<double> Scores(const Frame& frame, std::span<const KeyFrameId> ids) const;
  double Score(const Frame& frame, KeyFrameId id) const { return Scores(frame, {&id, 1})[0]; }
  int size() const;

  SavedPlaces Save() const;
  // Replaces the contents. Throws Error (input) if the nodes are not a valid vocabulary; the index
  // is then unchanged.
  void Restore(const SavedPlaces& saved, const std::vector<PlaceKeyFrame>& keyframes);

  size_t MemoryBytes() const;  // of words and index, without the frames' descriptors

 private:
  void GrowWhenDoubled();
  std::unique_ptr<WordIndex> Grown() const;

  PlaceSettings settings_;
  uint64_t seed_ = 1;
  std::mutex writer_;  // held during a whole change; serializes writers
  // Guards all members below; held exclusively while they change.
  mutable std::shared_mutex content_;
  std::unique_ptr<WordIndex> index_;
  uint32_t grown_at_ = 0;
};

}  // namespace alidade
