#include "alidade/place/place_index.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/random.h"

namespace alidade {

PlaceIndex::PlaceIndex(PlaceSettings settings, uint64_t seed)
    : settings_(settings),
      seed_(seed),
      index_(std::make_unique<WordIndex>(Vocabulary(), settings)) {
  settings_.Check();
}

void PlaceIndex::Add(KeyFrameId id, std::shared_ptr<const Frame> frame) {
  const std::lock_guard<std::mutex> writing(writer_);
  const std::vector<KeypointWord> words = WordsOf(*frame, index_->vocabulary());
  {
    const std::unique_lock<std::shared_mutex> lock(content_);
    index_->Erase(id);
    index_->Insert(id, std::move(frame), words);
  }
  GrowWhenDoubled();
}

void PlaceIndex::Remove(KeyFrameId id) {
  const std::lock_guard<std::mutex> writing(writer_);
  const std::unique_lock<std::shared_mutex> lock(content_);
  index_->Erase(id);
}

// Reads index_ without content_: only the writer changes it, and the caller holds writer_.
void PlaceIndex::GrowWhenDoubled() {
  if (index_->size() == 0 || static_cast<uint64_t>(index_->size()) < uint64_t{2} * grown_at_)
    return;
  std::unique_ptr<WordIndex> grown = Grown();
  const std::unique_lock<std::shared_mutex> lock(content_);
  index_.swap(grown);
  grown_at_ = static_cast<uint32_t>(index_->size());
}

std::unique_ptr<WordIndex> PlaceIndex::Grown() const {
  const auto keyframes = index_->KeyFrames();
  const int share = std::max(1, settings_.sample / static_cast<int>(keyframes.size()));
  Random random(seed_, keyframes.size());
  std::vector<Descriptor> sample;
  for (const auto& keyframe : keyframes) {
    // A random subset of `share` descriptors (partial Fisher–Yates shuffle).
    std::vector<Descriptor> descriptors = keyframe.second->descriptors;
    const size_t count = std::min(descriptors.size(), static_cast<size_t>(share));
    for (size_t i = 0; i < count; ++i) {
      const size_t left = descriptors.size() - i;
      std::swap(descriptors[i], descriptors[i + random.Below(static_cast<uint32_t>(left))]);
    }
    sample.insert(sample.end(), descriptors.begin(), descriptors.begin() + static_cast<int>(count));
  }
  auto grown = std::make_unique<WordIndex>(
      Vocabulary::Grow(sample, settings_.vocabulary, seed_ + keyframes.size()), settings_);
  for (const auto& keyframe : keyframes) {
    grown->Insert(keyframe.first, keyframe.second, WordsOf(*keyframe.second, grown->vocabulary()));
  }
  return grown;
}

std::vector<PlaceMatch> PlaceIndex::Query(const Frame& frame,
                                          const std::function<bool(KeyFrameId)>& may_be,
                                          size_t most) const {
  const std::shared_lock<std::shared_mutex> lock(content_);
  return index_->Query(frame, may_be, most);
}

std::vector<double> PlaceIndex::Scores(const Frame& frame, std::span<const KeyFrameId> ids) const {
  const std::shared_lock<std::shared_mutex> lock(content_);
  return index_->Scores(frame, ids);
}

int PlaceIndex::size() const {
  const std::shared_lock<std::shared_mutex> lock(content_);
  return index_->size();
}

SavedPlaces PlaceIndex::Save() const {
  const std::shared_lock<std::shared_mutex> lock(content_);
  return {index_->vocabulary().nodes(), grown_at_};
}

void PlaceIndex::Restore(const SavedPlaces& saved, const std::vector<PlaceKeyFrame>& keyframes) {
  if (saved.nodes.empty() != (saved.grown_at == 0)) {
    ThrowInput("places: a vocabulary and the number of keyframes it was grown at contradict");
  }
  auto restored = std::make_unique<WordIndex>(Vocabulary(saved.nodes), settings_);
  for (const auto& keyframe : keyframes) {
    if (!keyframe.second || restored->Has(keyframe.first)) {
      ThrowInput("places: keyframe " + std::to_string(keyframe.first.value) +
                 " is given twice or without its frame");
    }
    restored->Insert(keyframe.first, keyframe.second,
                     WordsOf(*keyframe.second, restored->vocabulary()));
  }
  const std::lock_guard<std::mutex> writing(writer_);
  {
    const std::unique_lock<std::shared_mutex> lock(content_);
    index_.swap(restored);
    grown_at_ = saved.grown_at;
  }
  GrowWhenDoubled();
}

size_t PlaceIndex::MemoryBytes() const {
  const std::shared_lock<std::shared_mutex> lock(content_);
  return index_->MemoryBytes();
}

}  // namespace alidade
