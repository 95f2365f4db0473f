#include "alidade/place/word_matching.h"

#include <algorithm>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/features/matching.h"

namespace alidade {
namespace {

constexpr int kNone = std::numeric_limits<int>::max();

}  // namespace

void WordMatchSettings::Check() const {
  if (level < 0) ThrowUsage("places.match_level cannot be negative");
  if (max_distance < 0 || max_distance > 256) {
    ThrowUsage("places.match_max_distance must lie in [0, 256]");
  }
  if (!(ratio > 0 && ratio <= 1)) ThrowUsage("places.match_ratio must lie in (0, 1]");
}

std::vector<KeypointWord> WordsOf(const Frame& frame, const Vocabulary& vocabulary) {
  std::vector<KeypointWord> words(frame.descriptors.size());
  for (uint32_t i = 0; i < words.size(); ++i) {
    words[i] = {vocabulary.WordOf(frame.descriptors[i]), i};
  }
  std::sort(words.begin(), words.end(), [](const KeypointWord& p, const KeypointWord& q) {
    return p.word != q.word ? p.word < q.word : p.keypoint < q.keypoint;
  });
  return words;
}

std::vector<KeypointWord> GroupsOf(std::vector<KeypointWord> words,
                                   std::span<const uint32_t> groups) {
  for (KeypointWord& word : words) word.word = groups[word.word];
  return words;
}

int CountMatches(const Frame& a, std::span<const KeypointWord> groups_a, const Frame& b,
                 std::span<const KeypointWord> groups_b, const WordMatchSettings& settings) {
  struct Partner {
    uint32_t keypoint = 0;
    int distance = kNone;
  };
  std::vector<Partner> of_b(b.descriptors.size());
  const std::vector<Descriptor> descriptors_b = b.descriptors;
  size_t begin_b = 0, end_b = 0;
  for (size_t i = 0; i < groups_a.size(); ++i) {
    const uint32_t group = groups_a[i].word;
    if (end_b == begin_b || groups_b[begin_b].word != group) {
      begin_b = end_b;
      while (begin_b < groups_b.size() && groups_b[begin_b].word < group) ++begin_b;
      end_b = begin_b;
      while (end_b < groups_b.size() && groups_b[end_b].word == group) ++end_b;
    }
    const Descriptor descriptor = a.descriptors[groups_a[i].keypoint];
    int best = kNone, second = kNone;
    uint32_t partner = 0;
    for (size_t k = begin_b; k < end_b; ++k) {
      const int distance = HammingDistance(descriptor, descriptors_b[groups_b[k].keypoint]);
      if (distance < best) {
        second = best;
        best = distance;
        partner = groups_b[k].keypoint;
      } else if (distance < second) {
        second = distance;
      }
    }
    if (best > settings.max_distance) continue;
    if (second != kNone && settings.ratio < 1 && best >= settings.ratio * second) continue;
    if (best < of_b[partner].distance) of_b[partner] = {groups_a[i].keypoint, best};
  }
  std::vector<float> turns;
  for (size_t k = 0; k < of_b.size(); ++k) {
    if (of_b[k].distance == kNone) continue;
    turns.push_back(a.keypoints[of_b[k].keypoint].angle - b.keypoints[k].angle);
  }
  const std::vector<bool> agree = ConsistentTurns(turns);
  return static_cast<int>(std::count(agree.begin(), agree.end(), true));
}

}  // namespace alidade
