#include "alidade/place/vocabulary.h"

#include <gtest/gtest.h>

#include "alidade/base/random.h"

namespace alidade {
namespace {

Descriptor RandomDescriptor(Random& random) {
  Descriptor d;
  for (uint64_t& w : d.words) w = (static_cast<uint64_t>(random.Next()) << 32) | random.Next();
  return d;
}

Descriptor Flipped(Descriptor d, int bits, Random& random) {
  for (int bit : random.Sample(bits, 256)) d.words[bit / 64] ^= uint64_t{1} << (bit % 64);
  return d;
}

// `copies` of each of `places` random descriptors, a few bits off.
std::vector<Descriptor> Clustered(int places, int copies, uint64_t seed) {
  Random random(seed);
  std::vector<Descriptor> sample;
  for (int p = 0; p < places; ++p) {
    const Descriptor centre = RandomDescriptor(random);
    for (int c = 0; c < copies; ++c) sample.push_back(Flipped(centre, 12, random));
  }
  return sample;
}

TEST(Vocabulary, WithNothingLearntHasOneWord) {
  Random random(1);
  EXPECT_EQ(Vocabulary().word_count(), 1u);
  EXPECT_EQ(Vocabulary().WordOf(RandomDescriptor(random)), 0u);
  EXPECT_EQ(Vocabulary::Grow({}, {}, 1).word_count(), 1u);
  const std::vector<Descriptor> same(100, RandomDescriptor(random));
  EXPECT_EQ(Vocabulary::Grow(same, {}, 1).word_count(), 1u);
}

TEST(Vocabulary, GivesDescriptorsOfOneClusterOneWord) {
  // 12 bits off each: two of a cluster differ by 24 bits at most, of two clusters by 128 or so.
  // Now and then two of one cluster are drawn as centres: then it is parted, and others are not.
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

}  // namespace
}  // namespace alidade
