// A tree of binary words, grown from the descriptors of the place itself: Gálvez-López & Tardós
// 2012, §III; the centre of a cluster is the majority of its members' bits (Grana et al. 2013).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/descriptor.h"

namespace ALIDADE_API alidade {

struct VocabularySettings {
  int branching = 10;  // children of a node at most
  int levels = 4;      // of children below the root: at most branching^levels words. 8, 16 or 20
                       // children and 3 or 5 levels find as many revisits
  int min_split = 16;  // descriptors of the sample: a node with fewer stays a word
  int rounds = 3;      // of assigning to centres and taking majorities, for each node
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// Immutable once made.
class Vocabulary {
 public:
  // Breadth first: the children of a node lie side by side, after those of all nodes before it.
  struct Node {
    Descriptor centre;
    uint32_t first_child = 0;  // index of a node; 0 for a leaf
    uint32_t children = 0;     // 0: a leaf, which is a word
  };
  static constexpr uint32_t kMaxNodes = 1 << 20;
  static constexpr int kMaxChildren = 64;  // with kMaxLevels, what finding one word may cost
  static constexpr int kMaxLevels = 8;

  Vocabulary() = default;  // one word, which everything is
  // Depends on its arguments only. Takes branching · levels · rounds distances per descriptor.
  static Vocabulary Grow(std::span<const Descriptor> sample, const VocabularySettings& settings,
                         uint64_t seed);
  // From a saved map. Throws Error (input) when the nodes do not make one tree in the order above.
  explicit Vocabulary(std::vector<Node> nodes);

  // The leaf reached by going to the nearest child, the first of equals. Words are numbered from
  // the left to the right of the tree, so those below one node follow each other.
  uint32_t WordOf(const Descriptor& descriptor) const;
  uint32_t word_count() const { return word_count_; }
  // For each word the first word below the node above it that lies `level` levels below the root;
  // itself when it is nearer to the root. Words with the same one are neighbours in the tree.
  std::vector<uint32_t> GroupsAt(int level) const;
  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  void NumberWords();

  std::vector<Node> nodes_;           // empty: one word
  std::vector<uint32_t> first_word_;  // below each node; of a leaf, its own
  uint32_t word_count_ = 1;
};

}  // namespace alidade
