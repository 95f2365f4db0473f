#include "alidade/place/vocabulary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "place/random_descriptors.h"
#include "support/expect_error.h"

namespace alidade::vocabulary_test {
namespace {

using Nodes = std::vector<Vocabulary::Node>;

bool Same(const Nodes& a, const Nodes& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.centre == q.centre && p.first_child == q.first_child && p.children == q.children;
  });
}

TEST(Vocabulary, WithNothingLearntHasOneWord) {
  Random random(1);
  EXPECT_EQ(Vocabulary().word_count(), 1u);
  EXPECT_EQ(Vocabulary().WordOf(RandomDescriptor(random)), 0u);
  EXPECT_EQ(Vocabulary().GroupsAt(3), std::vector<uint32_t>{0});
  EXPECT_EQ(Vocabulary::Grow({}, {}, 1).word_count(), 1u);
  const std::vector<Descriptor> same(100, RandomDescriptor(random));
  EXPECT_EQ(Vocabulary::Grow(same, {}, 1).word_count(), 1u);
}

TEST(Vocabulary, GivesDescriptorsOfOneClusterOneWord) {
  // 12 flipped bits each: two descriptors of a cluster differ by at most 24 bits, of different
  // clusters by about 128. Occasionally two centers are drawn from one cluster, which is then
  // split, and other clusters are merged.
  VocabularySettings settings;
  settings.branching = 16;
  settings.levels = 1;
  const std::vector<Descriptor> sample = Clustered(16, 15, 2);
  const Vocabulary vocabulary = Vocabulary::Grow(sample, settings, 1);
  int together = 0, by_chance = 0;
  for (size_t i = 0; i < sample.size(); ++i) {
    const uint32_t word = vocabulary.WordOf(sample[i]);
    together += word == vocabulary.WordOf(sample[i - i % 15]);
    by_chance += word == vocabulary.WordOf(sample[(i + 15) % sample.size()]);
  }
  EXPECT_GT(together, 200);  // of 240
  EXPECT_LT(by_chance, 60);
}

TEST(Vocabulary, HasTheMajorityOfItsMembersBitsForACentre) {
  VocabularySettings settings;
  settings.branching = 5;
  settings.levels = 1;
  settings.rounds = 100;  // until convergence
  Random random(3);
  std::vector<Descriptor> sample;
  for (int i = 0; i < 701; ++i) sample.push_back(RandomDescriptor(random));
  const Vocabulary vocabulary = Vocabulary::Grow(sample, settings, 1);
  ASSERT_EQ(vocabulary.word_count(), 5u);
  for (uint32_t word = 0; word < 5; ++word) {
    int members = 0;
    std::vector<int> ones(256, 0);
    for (const Descriptor& d : sample) {
      if (vocabulary.WordOf(d) != word) continue;
      ++members;
      for (int bit = 0; bit < 256; ++bit) ones[bit] += (d.words[bit / 64] >> (bit % 64)) & 1;
    }
    EXPECT_GT(members, 20);
    const Descriptor& centre = vocabulary.nodes()[1 + word].centre;
    for (int bit = 0; bit < 256; ++bit) {
      EXPECT_EQ((centre.words[bit / 64] >> (bit % 64)) & 1, 2 * ones[bit] > members ? 1u : 0u);
    }
  }
}

// Independent implementation: descends the nodes as documented.
uint32_t LeafOf(const Nodes& nodes, const Descriptor& d) {
  uint32_t at = 0;
  while (nodes[at].children > 0) {
    std::vector<std::pair<int, uint32_t>> to;
    for (uint32_t c = 0; c < nodes[at].children; ++c) {
      const uint32_t child = nodes[at].first_child + c;
      to.emplace_back(HammingDistance(d, nodes[child].centre), child);
    }
    at = std::min_element(to.begin(), to.end())->second;
  }
  return at;
}

TEST(Vocabulary, NumbersTheLeavesFromLeftToRight) {
  const std::vector<Descriptor> sample = Clustered(300, 12, 4);
  const Vocabulary vocabulary = Vocabulary::Grow(sample, {}, 1);
  const Nodes& nodes = vocabulary.nodes();
  // Recursive depth-first traversal: word of each leaf, first word of each node, and levels.
  std::vector<uint32_t> word(nodes.size(), 0), first(nodes.size(), 0);
  std::vector<std::vector<uint32_t>> groups(5);
  uint32_t words = 0;
  std::function<void(uint32_t, std::vector<uint32_t>)> visit = [&](uint32_t i,
                                                                   std::vector<uint32_t> above) {
    above.push_back(words);
    if (nodes[i].children == 0) {
      for (size_t l = 0; l < groups.size(); ++l) {
        groups[l].push_back(above[std::min(l, above.size() - 1)]);
      }
      word[i] = words++;
    }
    for (uint32_t c = 0; c < nodes[i].children; ++c) visit(nodes[i].first_child + c, above);
  };
  visit(0, {});
  EXPECT_EQ(vocabulary.word_count(), words);
  EXPECT_GT(words, 200u);
  for (int level = 0; level < 5; ++level) EXPECT_EQ(vocabulary.GroupsAt(level), groups[level]);
  EXPECT_EQ(groups[0], std::vector<uint32_t>(words, 0));
  for (const Descriptor& d : sample) EXPECT_EQ(vocabulary.WordOf(d), word[LeafOf(nodes, d)]);
}

TEST(Vocabulary, KeepsToItsBounds) {
  VocabularySettings settings;
  settings.branching = 3;
  settings.levels = 2;
  const std::vector<Descriptor> sample = Clustered(50, 20, 5);
  EXPECT_EQ(Vocabulary::Grow(sample, settings, 1).word_count(), 9u);
  settings.min_split = 1001;  // more than the sample has
  EXPECT_EQ(Vocabulary::Grow(sample, settings, 1).word_count(), 1u);
  settings.branching = 1;
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Vocabulary::Grow(sample, settings, 1); }),
              testing::HasSubstr("branching"));
}

TEST(Vocabulary, IsTheSameForTheSameSampleAndSeed) {
  const std::vector<Descriptor> sample = Clustered(100, 10, 6);
  const Nodes nodes = Vocabulary::Grow(sample, {}, 1).nodes();
  EXPECT_TRUE(Same(Vocabulary::Grow(sample, {}, 1).nodes(), nodes));
  EXPECT_FALSE(Same(Vocabulary::Grow(sample, {}, 2).nodes(), nodes));
}

TEST(Vocabulary, FindsTheSameWordsWhenMadeFromItsNodes) {
  const std::vector<Descriptor> sample = Clustered(100, 20, 7);
  const Vocabulary grown = Vocabulary::Grow(sample, {}, 1), read(grown.nodes());
  EXPECT_EQ(read.word_count(), grown.word_count());
  for (const Descriptor& d : sample) EXPECT_EQ(read.WordOf(d), grown.WordOf(d));
  EXPECT_EQ(Vocabulary(Nodes()).word_count(), 1u);
  EXPECT_EQ(Vocabulary(Nodes(1)).word_count(), 1u);
}

TEST(Vocabulary, RefusesNodesThatMakeNoTree) {
  const auto refused = [](Nodes nodes) {
    return MessageOf(ErrorKind::kInput, [&] { Vocabulary(std::move(nodes)); });
  };
  const auto node = [](uint32_t first, uint32_t children) {
    return Vocabulary::Node{{}, first, children};
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused({node(0, 2), node(0, 0), node(0, 0)}), HasSubstr("where they must be"));
  EXPECT_THAT(refused({node(2, 2), node(0, 0), node(0, 0)}), HasSubstr("where they must be"));
  EXPECT_THAT(refused({node(1, 2), node(1, 2), node(0, 0)}), HasSubstr("where they must be"));
  EXPECT_THAT(refused({node(1, 3), node(0, 0), node(0, 0)}), HasSubstr("than there are nodes"));
  EXPECT_THAT(refused({node(1, 0xffffffffu), node(0, 0)}), HasSubstr("than there can be"));
  Nodes wide(Vocabulary::kMaxChildren + 2);
  wide[0] = node(1, Vocabulary::kMaxChildren + 1);
  EXPECT_THAT(refused(wide), HasSubstr("than there can be"));
  EXPECT_THAT(refused({node(1, 2), node(0, 0), node(0, 0), node(0, 0)}), HasSubstr("no other's"));
  EXPECT_THAT(refused({node(0, 0), node(0, 0)}), HasSubstr("no other's"));
  EXPECT_THAT(refused({node(1, 1), node(0, 0)}), HasSubstr("one child"));
  EXPECT_THAT(refused({node(1, 2), node(0, 0), node(1, 0)}), HasSubstr("no children"));
  EXPECT_THAT(refused(Nodes(Vocabulary::kMaxNodes + 1)), HasSubstr("more nodes"));
  Nodes chain = {node(1, 2)};  // a chain: each second child has two children
  for (uint32_t i = 1; i <= Vocabulary::kMaxLevels; ++i) {
    chain.push_back(node(0, 0));
    chain.push_back(node(2 * i + 1, 2));
  }
  chain.insert(chain.end(), 2, node(0, 0));
  EXPECT_THAT(refused(chain), HasSubstr("deeper"));
}

TEST(Vocabulary, MadeOfSpoiltNodesIsRefusedOrWhole) {
  const std::vector<Descriptor> sample = Clustered(20, 20, 8);
  VocabularySettings settings;
  settings.branching = 4;
  const Nodes whole = Vocabulary::Grow(sample, settings, 1).nodes();
  Random random(9);
  int refused = 0;
  for (int turn = 0; turn < 3000; ++turn) {
    Nodes nodes = whole;
    for (uint32_t times = 1 + random.Below(3); times > 0; --times) {
      Vocabulary::Node& node = nodes[random.Below(static_cast<uint32_t>(nodes.size()))];
      const uint32_t drawn = random.Below(8) == 0 ? random.Next() : random.Below(12);
      switch (random.Below(5)) {
        case 0:
          node.first_child = drawn;
          break;
        case 1:
          node.children = drawn;
          break;
        case 2:
          node.first_child ^= 1u << random.Below(32);
          break;
        case 3:
          node.centre = RandomDescriptor(random);  // harmless
          break;
        default:
          nodes.resize(1 + random.Below(static_cast<uint32_t>(nodes.size())));
      }
    }
    try {
      const Vocabulary vocabulary(std::move(nodes));
      for (const Descriptor& d : sample) ASSERT_LT(vocabulary.WordOf(d), vocabulary.word_count());
      ASSERT_EQ(vocabulary.GroupsAt(2).size(), vocabulary.word_count());
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      ++refused;
    }
  }
  EXPECT_GT(refused, 1500);
  EXPECT_LT(refused, 3000);
}

}  // namespace
}  // namespace alidade::vocabulary_test
