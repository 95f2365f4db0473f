#include "alidade/place/word_index.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

// Calls visit(word, count) for each distinct word in order.
template <typename Visit>
void VisitWords(const std::vector<KeypointWord>& words, Visit&& visit) {
  for (size_t begin = 0, end = 0; begin < words.size(); begin = end) {
    while (end < words.size() && words[end].word == words[begin].word) ++end;
    visit(words[begin].word, static_cast<uint32_t>(end - begin));
  }
}

void SortBestFirst(std::vector<PlaceMatch>& matches, size_t most) {
  const auto better = [](const PlaceMatch& a, const PlaceMatch& b) {
    return a.score != b.score ? a.score > b.score : a.id < b.id;
  };
  const size_t kept = std::min(most, matches.size());
  std::partial_sort(matches.begin(), matches.begin() + static_cast<int>(kept), matches.end(),
                    better);
  matches.resize(kept);
}

}  // namespace

WordIndex::WordIndex(Vocabulary vocabulary, const PlaceSettings& settings)
    : vocabulary_(std::move(vocabulary)),
      settings_(settings),
      groups_(vocabulary_.GroupsAt(settings.matching.level)),
      postings_(vocabulary_.word_count()) {}

void WordIndex::Insert(KeyFrameId id, std::shared_ptr<const Frame> frame,
                       const std::vector<KeypointWord>& words) {
  auto slot = static_cast<uint32_t>(entries_.size());
  if (free_.empty()) {
    entries_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  VisitWords(words, [&](uint32_t word, uint32_t count) {
    Posting posting;
    posting.slot = slot & 0xffffff;
    posting.count = static_cast<uint8_t>(std::min<uint32_t>(count, 255));
    postings_[word].push_back(posting);
  });
  entries_[slot] = {id, std::move(frame), GroupsOf(words, groups_)};
  slots_[id] = slot;
}

void WordIndex::Erase(KeyFrameId id) {
  const auto found = slots_.find(id);
  if (found == slots_.end()) return;
  const uint32_t slot = found->second;
  VisitWords(WordsOf(*entries_[slot].frame, vocabulary_), [&](uint32_t word, uint32_t) {
    std::vector<Posting>& list = postings_[word];
    const auto of_slot = [&](const Posting& posting) { return posting.slot == slot; };
    list.erase(std::find_if(list.begin(), list.end(), of_slot));
  });
  slots_.erase(found);
  entries_[slot] = {};
  free_.push_back(slot);  // last: if this allocation fails, only the slot is lost
}

std::vector<PlaceKeyFrame> WordIndex::KeyFrames() const {
  std::vector<PlaceKeyFrame> keyframes;
  for (const auto& [id, slot] : slots_) keyframes.emplace_back(id, entries_[slot].frame);
  return keyframes;
}

// Ranks keyframes by common words, weighted by the inverse document frequency over the current
// keyframes. Not normalized by the keyframe's number of words, because it is only a preselection.
std::vector<PlaceMatch> WordIndex::Shortlist(const std::vector<KeypointWord>& words,
                                             const std::function<bool(KeyFrameId)>& may_be,
                                             size_t most) const {
  std::vector<double> common(entries_.size(), 0);
  VisitWords(words, [&](uint32_t word, uint32_t count) {
    const std::vector<Posting>& list = postings_[word];
    if (list.empty()) return;
    const double weight =
        std::log((static_cast<double>(size()) + 1) / static_cast<double>(list.size()));
    for (const Posting& posting : list) {
      common[posting.slot] += weight * std::min<uint32_t>(count, posting.count);
    }
  });
  std::vector<PlaceMatch> matches;
  for (const auto& [id, slot] : slots_) {
    if (common[slot] > 0 && (!may_be || may_be(id))) matches.push_back({id, common[slot]});
  }
  SortBestFirst(matches, most);
  return matches;
}

double WordIndex::Score(const Frame& frame, const std::vector<KeypointWord>& groups,
                        const Entry& entry) const {
  const int matches = CountMatches(frame, groups, *entry.frame, entry.groups, settings_.matching);
  if (matches == 0) return 0;
  return matches /
         std::sqrt(static_cast<double>(groups.size()) * static_cast<double>(entry.groups.size()));
}

std::vector<PlaceMatch> WordIndex::Query(const Frame& frame,
                                         const std::function<bool(KeyFrameId)>& may_be,
                                         size_t most) const {
  const std::vector<KeypointWord> words = WordsOf(frame, vocabulary_);
  const size_t listed = std::max(most, static_cast<size_t>(settings_.shortlist));
  const std::vector<PlaceMatch> likeliest = Shortlist(words, may_be, listed);
  const std::vector<KeypointWord> groups = GroupsOf(words, groups_);
  std::vector<PlaceMatch> matches;
  for (const PlaceMatch& likely : likeliest) {
    const double score = Score(frame, groups, entries_[slots_.at(likely.id)]);
    if (score > 0) matches.push_back({likely.id, score});
  }
  SortBestFirst(matches, most);
  return matches;
}

std::vector<double> WordIndex::Scores(const Frame& frame, std::span<const KeyFrameId> ids) const {
  const std::vector<KeypointWord> groups = GroupsOf(WordsOf(frame, vocabulary_), groups_);
  std::vector<double> scores(ids.size(), 0);
  for (size_t i = 0; i < ids.size(); ++i) {
    const auto found = slots_.find(ids[i]);
    if (found != slots_.end()) scores[i] = Score(frame, groups, entries_[found->second]);
  }
  return scores;
}

size_t WordIndex::MemoryBytes() const {
  constexpr size_t kMapNode = 48;  // estimated size of a std::map node
  size_t bytes = vocabulary_.nodes().size() * (sizeof(Vocabulary::Node) + sizeof(uint32_t)) +
                 groups_.size() * sizeof(groups_[0]) + entries_.capacity() * sizeof(Entry) +
                 postings_.capacity() * sizeof(std::vector<Posting>) + slots_.size() * kMapNode;
  for (const auto& list : postings_) bytes += list.capacity() * sizeof(Posting);
  for (const Entry& entry : entries_) bytes += entry.groups.capacity() * sizeof(KeypointWord);
  return bytes;
}

}  // namespace alidade
