// Growing a vocabulary tree: clusters the descriptors of each node into at most `branching`
// children.
#include <algorithm>
#include <numeric>
#include <utility>

#include "alidade/base/random.h"
#include "alidade/place/vocabulary.h"

namespace alidade {
namespace {

struct Clusters {
  std::vector<Descriptor> centres;
  std::vector<int> of;  // index of the center of each member
};

// Counts for each bit how many descriptors have it set. Bit-sliced: plane p holds bit p of all 256
// counters, so adding a descriptor is a ripple carry over the planes.
class BitCounter {
 public:
  void Add(const Descriptor& descriptor) {
    ++count_;
    Descriptor carry = descriptor;
    for (size_t p = 0; carry != Descriptor(); ++p) {
      if (p == planes_.size()) planes_.emplace_back();
      for (int w = 0; w < 4; ++w) {
        const uint64_t both = planes_[p].words[w] & carry.words[w];
        planes_[p].words[w] ^= carry.words[w];
        carry.words[w] = both;
      }
    }
  }
  int count() const { return count_; }
  // Bits set in more than half of the descriptors. Compares all counters with count / 2, highest
  // plane first.
  Descriptor Majority() const {
    const int half = count_ / 2;
    Descriptor majority;
    for (int w = 0; w < 4; ++w) {
      uint64_t more = 0, equal = ~uint64_t{0};
      for (size_t p = 31; p-- > 0;) {
        const uint64_t plane = p < planes_.size() ? planes_[p].words[w] : 0;
        const uint64_t bit = (half >> p) & 1 ? ~uint64_t{0} : 0;
        more |= equal & plane & ~bit;
        equal &= ~(plane ^ bit);
      }
      majority.words[w] = more;
    }
    return majority;
  }

 private:
  int count_ = 0;
  std::vector<Descriptor> planes_;  // least significant first
};

// k-means++ seeding (Arthur & Vassilvitskii 2007): draws each next center with probability
// proportional to the squared distance to the nearest existing one. Returns fewer centers if there
// are fewer distinct descriptors.
std::vector<Descriptor> DrawCentres(std::span<const Descriptor> sample,
                                    std::span<const int> members, int count, Random& random) {
  std::vector<Descriptor> centres;
  std::vector<int> nearest(members.size(), 256);
  int next = static_cast<int>(random.Below(static_cast<uint32_t>(members.size())));
  while (true) {
    centres.push_back(sample[members[next]]);
    if (static_cast<int>(centres.size()) == count) return centres;
    int64_t sum = 0;
    for (size_t i = 0; i < members.size(); ++i) {
      nearest[i] = std::min(nearest[i], HammingDistance(sample[members[i]], centres.back()));
      sum += int64_t{nearest[i]} * nearest[i];
    }
    if (sum == 0) return centres;
    auto left = static_cast<int64_t>(random.Uniform() * static_cast<double>(sum));
    next = 0;
    for (size_t i = 0; i < members.size() && left >= 0; ++i) {
      left -= int64_t{nearest[i]} * nearest[i];
      next = static_cast<int>(i);
    }
  }
}

// Assigns each member to its nearest center (the first on a tie). Returns true if any assignment
// changed.
bool Assign(std::span<const Descriptor> sample, std::span<const int> members, Clusters& clusters) {
  bool changed = false;
  for (size_t i = 0; i < members.size(); ++i) {
    const Descriptor& descriptor = sample[members[i]];
    int best = 0, nearest = 257;
    for (int c = 0; c < static_cast<int>(clusters.centres.size()); ++c) {
      const int distance = HammingDistance(descriptor, clusters.centres[c]);
      if (distance < nearest) {
        nearest = distance;
        best = c;
      }
    }
    changed = changed || clusters.of[i] != best;
    clusters.of[i] = best;
  }
  return changed;
}

Clusters Part(std::span<const Descriptor> sample, std::span<const int> members,
              const VocabularySettings& settings, Random& random) {
  Clusters clusters;
  clusters.centres = DrawCentres(sample, members, settings.branching, random);
  clusters.of.assign(members.size(), -1);
  for (int round = 0; Assign(sample, members, clusters) && round < settings.rounds; ++round) {
    std::vector<BitCounter> counters(clusters.centres.size());
    for (size_t i = 0; i < members.size(); ++i) counters[clusters.of[i]].Add(sample[members[i]]);
    for (size_t c = 0; c < counters.size(); ++c) {
      if (counters[c].count() > 0) clusters.centres[c] = counters[c].Majority();
    }
  }
  return clusters;
}

}  // namespace

Vocabulary Vocabulary::Grow(std::span<const Descriptor> sample, const VocabularySettings& settings,
                            uint64_t seed) {
  settings.Check();
  Vocabulary vocabulary;
  if (sample.empty()) return vocabulary;
  Random random(seed);
  struct Branch {
    int level = 0;
    std::vector<int> members;  // indices into the sample
  };
  std::vector<Branch> branches(1);  // one per node
  branches[0].members.resize(sample.size());
  std::iota(branches[0].members.begin(), branches[0].members.end(), 0);
  vocabulary.nodes_.emplace_back();
  for (size_t i = 0; i < branches.size(); ++i) {
    const Branch branch = std::move(branches[i]);
    if (branch.level == settings.levels ||
        static_cast<int>(branch.members.size()) < settings.min_split ||
        vocabulary.nodes_.size() + settings.branching > kMaxNodes) {
      continue;
    }
    const Clusters clusters = Part(sample, branch.members, settings, random);
    std::vector<Branch> children(clusters.centres.size());
    for (size_t m = 0; m < branch.members.size(); ++m) {
      children[clusters.of[m]].members.push_back(branch.members[m]);
    }
    const auto empty = [](const Branch& child) { return child.members.empty(); };
    if (std::count_if(children.begin(), children.end(), empty) + 2 >
        static_cast<int>(children.size())) {
      continue;  // fewer than two nonempty children: no split
    }
    vocabulary.nodes_[i].first_child = static_cast<uint32_t>(vocabulary.nodes_.size());
    for (size_t c = 0; c < children.size(); ++c) {
      if (children[c].members.empty()) continue;
      children[c].level = branch.level + 1;
      branches.push_back(std::move(children[c]));
      vocabulary.nodes_.push_back({clusters.centres[c], 0, 0});
      ++vocabulary.nodes_[i].children;
    }
  }
  vocabulary.NumberWords();
  return vocabulary;
}

}  // namespace alidade
