#include "alidade/place/word_matching.h"

#include <algorithm>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/features/matching.h"

namespace alidade {
namespace {

constexpr int kNone = std::numeric_limits<int>::max();

// The end of the run of words that lie below the same node as the one at `begin`.
size_t EndOfGroup(std::span<const KeypointWord> words, size_t begin,
                  std::span<const uint32_t> groups) {
  const uint32_t group = groups[words[begin].word];
  size_t end = begin + 1;
  while (end < words.size() && groups[words[end].word] == group) ++end;
  return end;
}

}  // namespace

void WordMatchSettings::Check() const {
  if (level < 0) ThrowUsage("place.matching.level cannot be negative");
  if (max_distance < 0 || max_distance > 256) {
    ThrowUsage("place.matching.max_distance must lie in [0, 256]");
  }
  if (!(ratio > 0 && ratio <= 1)) ThrowUsage("place.matching.ratio must lie in (0, 1]");
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

int CountMatches(const Frame& a, std::span<const KeypointWord> words_a, const Frame& b,
                 std::span<const KeypointWord> words_b, std::span<const uint32_t> groups,
                 const WordMatchSettings& settings) {
  struct Partner {
    uint32_t keypoint = 0;
    int distance = kNone;
  };
  std::vector<Partner> of_b(b.descriptors.size());
  size_t i = 0, j = 0;
  while (i < words_a.size() && j < words_b.size()) {
    const uint32_t group_a = groups[words_a[i].word], group_b = groups[words_b[j].word];
    if (group_a < group_b) {
      ++i;
      continue;
    }
    if (group_b < group_a) {
      ++j;
      continue;
    }
    const size_t end_a = EndOfGroup(words_a, i, groups), end_b = EndOfGroup(words_b, j, groups);
    for (; i < end_a; ++i) {
      const Descriptor descriptor = a.descriptors[words_a[i].keypoint];
      int best = kNone, second = kNone;
      uint32_t partner = 0;
      for (size_t k = j; k < end_b; ++k) {
        const int distance = HammingDistance(descriptor, b.descriptors[words_b[k].keypoint]);
        if (distance < best) {
          second = best;
          best = distance;
          partner = words_b[k].keypoint;
        } else if (distance < second) {
          second = distance;
        }
      }
      if (best > settings.max_distance) continue;
      if (second != kNone && settings.ratio < 1 && best >= settings.ratio * second) continue;
      if (best < of_b[partner].distance) of_b[partner] = {words_a[i].keypoint, best};
    }
    j = end_b;
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
