#include "alidade/place/vocabulary.h"

#include <string>
#include <utility>

#include "alidade/base/error.h"

namespace alidade {

void VocabularySettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("places.") + what);
  };
  require(branching >= 2 && branching <= Vocabulary::kMaxChildren, "branching must lie in [2, 64]");
  require(levels >= 1 && levels <= Vocabulary::kMaxLevels, "levels must lie in [1, 8]");
  require(min_split >= 2, "min_split must be 2 or more");
  require(rounds >= 1, "rounds must be positive");
}

Vocabulary::Vocabulary(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
  if (nodes_.size() > kMaxNodes) ThrowInput("vocabulary: more nodes than there can be");
  uint64_t next = 1;  // index of the first node without a parent so far
  std::vector<uint8_t> level(nodes_.size(), 0);
  for (size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    const std::string name = "vocabulary: node " + std::to_string(i);
    if (i > 0 && i >= next) ThrowInput(name + " is no other's child");
    if (node.children == 0) {
      if (node.first_child != 0) ThrowInput(name + " has a first child, but no children");
      continue;
    }
    if (node.children == 1) ThrowInput(name + " has one child only");
    if (node.children > kMaxChildren) ThrowInput(name + " has more children than there can be");
    if (node.first_child != next) ThrowInput(name + "'s children are not where they must be");
    next += node.children;
    if (next > nodes_.size()) ThrowInput(name + " has more children than there are nodes");
    if (level[i] == kMaxLevels) ThrowInput("vocabulary: deeper than it can be");
    for (uint64_t c = node.first_child; c < next; ++c) level[c] = level[i] + 1;
  }
  NumberWords();
}

void Vocabulary::NumberWords() {
  if (nodes_.empty()) return;
  // Number of words below each node; parents precede their children.
  std::vector<uint32_t> words(nodes_.size(), 0);
  for (size_t i = nodes_.size(); i-- > 0;) {
    const Node& node = nodes_[i];
    if (node.children == 0) words[i] = 1;
    for (uint32_t c = 0; c < node.children; ++c) words[i] += words[node.first_child + c];
  }
  first_word_.assign(nodes_.size(), 0);
  for (size_t i = 0; i < nodes_.size(); ++i) {
    uint32_t first = first_word_[i];
    for (uint32_t c = nodes_[i].first_child; c < nodes_[i].first_child + nodes_[i].children; ++c) {
      first_word_[c] = first;
      first += words[c];
    }
  }
  word_count_ = words[0];
}

std::vector<uint32_t> Vocabulary::GroupsAt(int level) const {
  std::vector<uint32_t> of_word(word_count_, 0);
  std::vector<uint32_t> of_node(nodes_.size(), 0);
  std::vector<int> levels(nodes_.size(), 0);
  for (uint32_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (levels[i] <= level) of_node[i] = first_word_[i];
    if (node.children == 0) of_word[first_word_[i]] = of_node[i];
    for (uint32_t c = node.first_child; c < node.first_child + node.children; ++c) {
      levels[c] = levels[i] + 1;
      of_node[c] = of_node[i];
    }
  }
  return of_word;
}

uint32_t Vocabulary::WordOf(const Descriptor& descriptor) const {
  if (nodes_.empty()) return 0;
  uint32_t at = 0;
  while (nodes_[at].children > 0) {
    const uint32_t first = nodes_[at].first_child, end = first + nodes_[at].children;
    int nearest = HammingDistance(descriptor, nodes_[first].centre);
    at = first;
    for (uint32_t c = first + 1; c < end; ++c) {
      const int distance = HammingDistance(descriptor, nodes_[c].centre);
      if (distance < nearest) {
        nearest = distance;
        at = c;
      }
    }
  }
  return first_word_[at];
}

}  // namespace alidade
