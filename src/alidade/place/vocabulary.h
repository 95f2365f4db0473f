// Vocabulary tree of binary words, grown from the map's own descriptors (Gálvez-López & Tardós
// 2012, §III). A cluster's center is the bitwise majority of its members (Grana et al. 2013).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/descriptor.h"

namespace ALIDADE_API alidade {

struct VocabularySettings {
  // Most children of a node. 8, 16 or 20 of them and 3 or 5 levels find as many revisits.
  int branching = 10;
  // At most branching^levels words.
  int levels = 4;
  // A node with fewer descriptors of the sample stays a word.
  int min_split = 16;
  // Rounds of assigning descriptors to centers and taking majorities, for each node.
  int rounds = 3;
  void Check() const;  // throws Error (usage) naming the invalid field
};

// Immutable after construction.
class Vocabulary {
 public:
  // Stored breadth-first: the children of a node are contiguous, after those of all preceding
  // nodes.
  struct Node {
    Descriptor centre;
    uint32_t first_child = 0;  // node index; 0 for a leaf
    uint32_t children = 0;     // 0: a leaf, i.e. a word
  };
  static constexpr uint32_t kMaxNodes = 1 << 20;
  // With kMaxLevels, bounds the cost of looking up one word.
  static constexpr int kMaxChildren = 64;
  static constexpr int kMaxLevels = 8;

  Vocabulary() = default;  // a single word for all descriptors
  // Deterministic. Computes about branching · levels · rounds distances per descriptor.
  static Vocabulary Grow(std::span<const Descriptor> sample, const VocabularySettings& settings,
                         uint64_t seed);
  // From a saved map. Throws Error (input) if the nodes are not a tree in breadth-first order.
  explicit Vocabulary(std::vector<Node> nodes);

  // The leaf reached by descending to the nearest child (the first on a tie). Words are numbered
  // from left to right, so the words below a node are consecutive.
  uint32_t WordOf(const Descriptor& descriptor) const;
  uint32_t word_count() const { return word_count_; }
  // For each word, the first word below its ancestor at depth `level` below the root; the word
  // itself if it is not deeper. Words with the same value are in the same subtree.
  std::vector<uint32_t> GroupsAt(int level) const;
  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  void NumberWords();

  std::vector<Node> nodes_;           // empty: one word
  std::vector<uint32_t> first_word_;  // first word below each node; a leaf's own word
  uint32_t word_count_ = 1;
};

}  // namespace alidade
