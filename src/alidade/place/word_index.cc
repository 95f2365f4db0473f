#include "alidade/place/word_index.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace alidade {

WordIndex::WordIndex(Vocabulary vocabulary)
    : vocabulary_(std::move(vocabulary)), postings_(vocabulary_.word_count()) {}

WordIndex::Bag WordIndex::BagOf(const Frame& frame) const {
  std::vector<uint32_t> words;
  words.reserve(frame.descriptors.size());
  for (const Descriptor& descriptor : frame.descriptors) {
    words.push_back(vocabulary_.WordOf(descriptor));
  }
  std::sort(words.begin(), words.end());
  Bag bag;
  for (uint32_t word : words) {
    if (bag.empty() || bag.back().word != word) bag.push_back({word, 0});
    ++bag.back().count;
  }
  return bag;
}

void WordIndex::Insert(KeyFrameId id, std::shared_ptr<const Frame> frame, Bag bag) {
  uint32_t slot = static_cast<uint32_t>(entries_.size());
  if (free_.empty()) {
    entries_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  for (const WordCount& word : bag) postings_[word.word].push_back({slot, word.count});
  entries_[slot] = {id, std::move(frame), std::move(bag)};
  slots_[id] = slot;
}

void WordIndex::Erase(KeyFrameId id) {
  const auto found = slots_.find(id);
  if (found == slots_.end()) return;
  const uint32_t slot = found->second;
  for (const WordCount& word : entries_[slot].bag) {
    std::vector<Posting>& list = postings_[word.word];
    const auto of_slot = [&](const Posting& posting) { return posting.slot == slot; };
    list.erase(std::find_if(list.begin(), list.end(), of_slot));
  }
  entries_[slot] = {};
  free_.push_back(slot);
  slots_.erase(found);
}

std::vector<std::pair<KeyFrameId, std::shared_ptr<const Frame>>> WordIndex::KeyFrames() const {
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Frame>>> keyframes;
  for (const auto& [id, slot] : slots_) keyframes.emplace_back(id, entries_[slot].frame);
  return keyframes;
}

double WordIndex::Weight(uint32_t word) const {
  const auto with_word = static_cast<double>(std::max<size_t>(1, postings_[word].size()));
  return std::log((static_cast<double>(slots_.size()) + 1) / with_word);
}

std::vector<PlaceMatch> WordIndex::Query(const Frame& frame,
                                         const std::function<bool(KeyFrameId)>& may_be,
                                         size_t most) const {
  std::vector<double> common(entries_.size(), 0);
  double all = 0;
  for (const WordCount& word : BagOf(frame)) {
    const double weight = Weight(word.word);
    all += weight * word.count;
    for (const Posting& posting : postings_[word.word]) {
      common[posting.slot] += weight * std::min(word.count, posting.count);
    }
  }
  std::vector<PlaceMatch> matches;
  for (const auto& [id, slot] : slots_) {
    if (common[slot] > 0 && (!may_be || may_be(id))) matches.push_back({id, common[slot] / all});
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const PlaceMatch& a, const PlaceMatch& b) { return a.score > b.score; });
  if (matches.size() > most) matches.resize(most);
  return matches;
}

double WordIndex::Score(const Frame& frame, KeyFrameId id) const {
  const auto found = slots_.find(id);
  if (found == slots_.end()) return 0;
  const Bag& bag = entries_[found->second].bag;
  double common = 0, all = 0;
  size_t at = 0;
  for (const WordCount& word : BagOf(frame)) {
    const double weight = Weight(word.word);
    all += weight * word.count;
    while (at < bag.size() && bag[at].word < word.word) ++at;
    if (at < bag.size() && bag[at].word == word.word) {
      common += weight * std::min(word.count, bag[at].count);
    }
  }
  return common > 0 ? common / all : 0;
}

size_t WordIndex::MemoryBytes() const {
  size_t bytes = vocabulary_.nodes().size() * (sizeof(Vocabulary::Node) + sizeof(uint32_t));
  bytes += postings_.capacity() * sizeof(postings_[0]) + entries_.capacity() * sizeof(Entry);
  for (const auto& list : postings_) bytes += list.capacity() * sizeof(Posting);
  for (const Entry& entry : entries_) bytes += entry.bag.capacity() * sizeof(WordCount);
  return bytes + slots_.size() * 48;  // a node of the map
}

}  // namespace alidade
