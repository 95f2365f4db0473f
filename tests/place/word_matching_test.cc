#include "alidade/place/word_matching.h"

#include <gtest/gtest.h>

#include "alidade/features/matching.h"
#include "place/random_descriptors.h"
#include "support/expect_error.h"

namespace alidade::word_matching_test {
namespace {

struct Pair {
  Frame a, b;
};

// 200 common keypoints with 15 flipped bits in another order, and 100 different ones in each frame.
Pair MakePair(uint64_t seed) {
  Random random(seed);
  std::vector<Descriptor> a, b(300);
  for (int i = 0; i < 300; ++i) a.push_back(RandomDescriptor(random));
  const std::vector<int> order = random.Sample(300, 300);
  for (int i = 0; i < 300; ++i) {
    b[order[i]] = i < 200 ? Flipped(a[i], 15, random) : RandomDescriptor(random);
  }
  return {FrameOf(std::move(a)), FrameOf(std::move(b))};
}

int Matches(const Frame& a, const Frame& b, const Vocabulary& vocabulary,
            const WordMatchSettings& settings) {
  const std::vector<uint32_t> groups = vocabulary.GroupsAt(settings.level);
  return CountMatches(a, GroupsOf(WordsOf(a, vocabulary), groups), b,
                      GroupsOf(WordsOf(b, vocabulary), groups), settings);
}

TEST(WordsOf, ListsEachKeypointOnceInOrderOfWords) {
  const Frame frame = MakePair(1).a;
  const Vocabulary vocabulary = Vocabulary::Grow(frame.descriptors, {}, 1);
  const std::vector<KeypointWord> words = WordsOf(frame, vocabulary);
  ASSERT_EQ(words.size(), 300u);
  std::vector<int> seen(300, 0);
  for (size_t i = 0; i < words.size(); ++i) {
    ++seen[words[i].keypoint];
    EXPECT_EQ(words[i].word, vocabulary.WordOf(frame.descriptors[words[i].keypoint]));
    if (i > 0 && words[i].word == words[i - 1].word) {
      EXPECT_GT(words[i].keypoint, words[i - 1].keypoint);
    } else if (i > 0) {
      EXPECT_GT(words[i].word, words[i - 1].word);
    }
  }
  EXPECT_EQ(seen, std::vector<int>(300, 1));
}

TEST(CountMatches, BelowTheRootIsMatchingAllAgainstAll) {
  const Pair pair = MakePair(2);
  const Vocabulary vocabulary = Vocabulary::Grow(pair.a.descriptors, {}, 1);
  const WordMatchSettings settings{.level = 0, .max_distance = 60, .ratio = 0.8};
  EXPECT_EQ(MatchBruteForce(pair.a, pair.b, {.max_distance = 60, .ratio = 0.8}).size(), 200u);
  EXPECT_EQ(Matches(pair.a, pair.b, vocabulary, settings), 200);
  EXPECT_EQ(Matches(pair.b, pair.a, vocabulary, settings), 200);
}

TEST(CountMatches, FindsFewerTheDeeperItLooksAndNoneThatAreNotThere) {
  const Pair pair = MakePair(3), other = MakePair(4);
  VocabularySettings tree;
  tree.branching = 4;
  const Vocabulary vocabulary = Vocabulary::Grow(pair.a.descriptors, tree, 1);
  int last = 200;
  for (int level = 1; level <= 3; ++level) {
    const int found = Matches(pair.a, pair.b, vocabulary, {.level = level});
    EXPECT_LE(found, last);
    EXPECT_GT(found, 20);  // random bits cannot be clustered well
    EXPECT_EQ(Matches(pair.a, other.b, vocabulary, {.level = level}), 0);
    last = found;
  }
  EXPECT_LT(last, 190);
}

TEST(CountMatches, IsOneToOne) {
  // Two keypoints of a are similar to the same one of b.
  Random random(5);
  const Descriptor d = RandomDescriptor(random);
  const Frame a = FrameOf({Flipped(d, 3, random), Flipped(d, 9, random), RandomDescriptor(random)});
  const Frame b = FrameOf({RandomDescriptor(random), d});
  EXPECT_EQ(Matches(a, b, Vocabulary(), {}), 1);
  EXPECT_EQ(Matches(a, a, Vocabulary(), {}), 3);
  EXPECT_EQ(Matches(a, Frame(), Vocabulary(), {}), 0);
  EXPECT_EQ(Matches(Frame(), b, Vocabulary(), {}), 0);
}

TEST(CountMatches, LeavesOutMatchesThatTurnUnlikeTheRest) {
  Pair pair = MakePair(6);
  for (Keypoint& k : pair.b.keypoints) k.angle = 0.5f;
  // A third of a's keypoints is rotated by random angles.
  Random random(7);
  for (int i = 0; i < 200; i += 3) {
    pair.a.keypoints[i].angle = static_cast<float>(random.Uniform(1.0, 6.0));
  }
  const int found = Matches(pair.a, pair.b, Vocabulary(), {});
  EXPECT_GE(found, 133);
  EXPECT_LT(found, 160);
}

TEST(WordMatchSettings, AreChecked) {
  const auto message = [](WordMatchSettings settings) {
    return MessageOf(ErrorKind::kUsage, [&] { settings.Check(); });
  };
  EXPECT_THAT(message({.level = -1}), testing::HasSubstr("level"));
  EXPECT_THAT(message({.max_distance = 257}), testing::HasSubstr("max_distance"));
  EXPECT_THAT(message({.ratio = 0}), testing::HasSubstr("ratio"));
}

}  // namespace
}  // namespace alidade::word_matching_test
