#include "alidade/place/place_index.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "alidade/base/parallel.h"
#include "place/random_descriptors.h"
#include "place/rendered_places.h"
#include "support/expect_error.h"

namespace alidade::place_index_test {
namespace {

// Views of an artificial world: 100 keypoints each, half of them shared with the next view. Each
// seed flips 10 random bits per descriptor.
std::vector<SharedFrame> Views(int count, uint64_t seed) {
  Random world(11), random(seed);
  std::vector<Descriptor> points;
  for (int i = 0; i < 50 * (count + 1); ++i) points.push_back(RandomDescriptor(world));
  std::vector<SharedFrame> frames;
  for (int i = 0; i < count; ++i) {
    std::vector<Descriptor> seen;
    for (int k = 0; k < 100; ++k) seen.push_back(Flipped(points[50 * i + k], 10, random));
    frames.push_back(std::make_shared<Frame>(FrameOf(std::move(seen))));
  }
  return frames;
}

using Answers = std::vector<std::pair<uint32_t, double>>;

Answers AllAnswers(const PlaceIndex& index, const std::vector<SharedFrame>& queries) {
  Answers answers;
  for (const SharedFrame& query : queries) {
    for (const PlaceMatch& match : index.Query(*query, {}, 10)) {
      answers.emplace_back(match.id.value, match.score);
    }
  }
  return answers;
}

// A lap around a room and a second lap at other times, with views of other rooms in the index.
TEST(PlaceIndex, FindsARevisitAmongOtherPlaces) {
  const std::vector<SharedFrame> room = RenderPlaces("room", 0, 4, 14),
                                 again = RenderPlaces("room", 57, 4, 14),
                                 wall = RenderPlaces("wall", 0, 6, 5),
                                 desk = RenderPlaces("desk", 0, 6, 5);
  PlaceIndex index;
  for (uint32_t i = 0; i < 14; ++i) {
    // Add the views one by one, interleaved with other places.
    index.Add({i}, room[i]);
    if (i < 10) index.Add({100 + i}, i % 2 == 0 ? wall[i / 2] : desk[i / 2]);
    for (uint32_t k = 0; k <= i; ++k) {
      const std::vector<PlaceMatch> found = index.Query(*again[k], {}, 5);
      ASSERT_FALSE(found.empty());
      EXPECT_EQ(found[0].id.value, k) << "of " << index.size();
      for (size_t m = 0; m < found.size(); ++m) {
        EXPECT_EQ(index.Score(*again[k], found[m].id), found[m].score);
        EXPECT_LE(found[m].score, m > 0 ? found[m - 1].score : 1);
        EXPECT_GT(found[m].score, 0);
        const bool elsewhere = found[m].id.value >= 100;
        EXPECT_TRUE(!elsewhere || found[m].score < found[0].score / 2);
      }
    }
  }
}

TEST(PlaceIndex, OfNothingFindsNothing) {
  const std::vector<SharedFrame> views = Views(2, 1);
  PlaceIndex index;
  EXPECT_TRUE(index.Query(*views[0], {}, 5).empty());
  EXPECT_EQ(index.Score(*views[0], {0}), 0);
  index.Add({0}, views[0]);
  EXPECT_TRUE(index.Query(Frame(), {}, 10).empty());
  EXPECT_EQ(index.Score(Frame(), {0}), 0);
  index.Add({1}, std::make_shared<Frame>());
  EXPECT_EQ(index.Score(*views[0], {1}), 0);
  EXPECT_EQ(index.Query(*views[0], {}, 5).size(), 1u);
}

TEST(PlaceIndex, ScoresThoseNamed) {
  const std::vector<SharedFrame> room = Views(12, 1), again = Views(12, 2);
  PlaceIndex index;
  for (uint32_t i = 0; i < 12; ++i) index.Add({i}, room[i]);
  const std::vector<KeyFrameId> ids = {{7}, {50}, {6}, {7}, {1}};
  const std::vector<double> scores = index.Scores(*again[7], ids);
  ASSERT_EQ(scores.size(), 5u);
  EXPECT_GT(scores[0], 0.5);
  EXPECT_EQ(scores[1], 0);
  EXPECT_GT(scores[2], 0.2);  // half of the view is shared
  EXPECT_LT(scores[2], scores[0]);
  EXPECT_EQ(scores[3], scores[0]);
  EXPECT_LT(scores[4], scores[2]);
  EXPECT_TRUE(index.Scores(*again[7], {}).empty());
}

TEST(PlaceIndex, AsksWhichMayBe) {
  const std::vector<SharedFrame> room = Views(19, 1), again = Views(19, 2);
  PlaceIndex index;
  for (uint32_t i = 0; i < 19; ++i) index.Add({i}, room[i]);
  const auto even = [](KeyFrameId id) { return id.value % 2 == 0; };
  const std::vector<PlaceMatch> found = index.Query(*again[7], even, 30);
  EXPECT_GE(found.size(), 2u);
  for (const PlaceMatch& match : found) EXPECT_EQ(match.id.value % 2, 0u);
  EXPECT_TRUE(index
                  .Query(
                      *again[7], [](KeyFrameId) { return false; }, 30)
                  .empty());
  EXPECT_TRUE(index.Query(*again[7], {}, 0).empty());
}

TEST(PlaceIndex, BreaksTiesById) {
  const std::vector<SharedFrame> room = Views(1, 1);
  PlaceIndex index;
  for (uint32_t id : {5u, 2u, 9u}) index.Add({id}, room[0]);
  const std::vector<PlaceMatch> found = index.Query(*room[0], {}, 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].id.value, 2u);
  EXPECT_EQ(found[1].id.value, 5u);
  EXPECT_EQ(found[0].score, found[1].score);
}

TEST(PlaceIndex, ForgetsWhatIsRemovedAndReplacesWhatIsAddedAgain) {
  const std::vector<SharedFrame> room = Views(19, 1), again = Views(19, 2);
  PlaceIndex index;
  for (uint32_t i = 0; i < 19; ++i) index.Add({i}, room[i]);
  index.Remove({7});
  index.Remove({7});
  index.Remove({1000});
  EXPECT_EQ(index.size(), 18);
  EXPECT_EQ(index.Score(*again[7], {7}), 0);
  for (const PlaceMatch& match : index.Query(*again[7], {}, 100)) {
    EXPECT_NE(match.id.value, 7u);
  }
  index.Add({3}, room[7]);
  EXPECT_EQ(index.size(), 18);
  EXPECT_EQ(index.Query(*again[7], {}, 1).at(0).id.value, 3u);
  for (uint32_t i = 0; i < 19; ++i) index.Remove({i});
  EXPECT_EQ(index.size(), 0);
  EXPECT_TRUE(index.Query(*again[7], {}, 1).empty());
}

TEST(PlaceIndex, GrowsAnewWhenKeyframesHaveDoubled) {
  PlaceIndex index;
  EXPECT_EQ(index.Save().grown_at, 0u);
  const std::vector<SharedFrame> frames = Views(40, 1);
  for (uint32_t i = 0; i < 40; ++i) {
    index.Add({i}, frames[i]);
    uint32_t power = 1;
    while (2 * power <= i + 1) power *= 2;
    EXPECT_EQ(index.Save().grown_at, power);
  }
  EXPECT_GT(index.Save().nodes.size(), 100u);
  EXPECT_GT(index.MemoryBytes(), index.Save().nodes.size() * sizeof(Vocabulary::Node));
}

TEST(PlaceIndex, AnswersTheSameWithAnyNumberOfThreads) {
  const std::vector<SharedFrame> room = Views(40, 1), again = Views(40, 2);
  const auto answers = [&] {
    PlaceIndex index;
    for (uint32_t i = 0; i < 40; ++i) index.Add({i}, room[i]);
    return AllAnswers(index, again);
  };
  SetThreadCount(1);
  const Answers alone = answers();
  SetThreadCount(2);
  EXPECT_EQ(answers(), alone);
  SetThreadCount(0);
}

TEST(PlaceIndex, GoesOnAfterRestoringAsIfItHadNotBeenSaved) {
  const std::vector<SharedFrame> room = Views(41, 1), again = Views(41, 2);
  PlaceIndex index;
  uint32_t next = 0;
  std::vector<PlaceKeyFrame> in;
  for (; next < 13; ++next) index.Add({next}, room[next]);
  for (uint32_t gone : {2u, 3u, 11u}) index.Remove({gone});
  for (uint32_t id = 0; id < next; ++id) {
    if (id != 2 && id != 3 && id != 11) in.emplace_back(KeyFrameId{id}, room[id]);
  }
  PlaceIndex restored;
  restored.Add({77}, room[30]);  // replaced by Restore()
  restored.Restore(index.Save(), in);
  EXPECT_EQ(restored.size(), 10);
  EXPECT_EQ(AllAnswers(restored, again), AllAnswers(index, again));
  for (; next < 41; ++next) {
    index.Add({next}, room[next]);
    restored.Add({next}, room[next]);
    if (next % 9 == 0) {
      index.Remove({next - 5});
      restored.Remove({next - 5});
    }
    EXPECT_EQ(restored.Save().grown_at, index.Save().grown_at);
    EXPECT_EQ(restored.Save().nodes.size(), index.Save().nodes.size());
  }
  EXPECT_EQ(AllAnswers(restored, again), AllAnswers(index, again));
}

TEST(PlaceIndex, RefusesWhatCannotHaveBeenSavedAndStaysAsItWas) {
  const std::vector<SharedFrame> room = Views(10, 1);
  PlaceIndex index;
  for (uint32_t i = 0; i < 4; ++i) index.Add({i}, room[i]);
  const SavedPlaces good = index.Save();
  const std::vector<PlaceKeyFrame> keyframes = {{{8}, room[8]}, {{9}, room[9]}};
  const auto refused = [&](const SavedPlaces& saved, const std::vector<PlaceKeyFrame>& with) {
    const std::string message = MessageOf(ErrorKind::kInput, [&] { index.Restore(saved, with); });
    EXPECT_EQ(index.size(), 4);
    EXPECT_EQ(index.Query(*room[2], {}, 1).at(0).id.value, 2u);
    return message;
  };
  SavedPlaces spoilt = good;
  spoilt.nodes[0].first_child = 0;
  EXPECT_THAT(refused(spoilt, keyframes), testing::HasSubstr("node 0"));
  spoilt = good;
  spoilt.grown_at = 0;
  EXPECT_THAT(refused(spoilt, keyframes), testing::HasSubstr("contradict"));
  EXPECT_THAT(refused({{}, 3}, keyframes), testing::HasSubstr("contradict"));
  EXPECT_THAT(refused(good, {{{8}, room[8]}, {{8}, room[9]}}), testing::HasSubstr("twice"));
  EXPECT_THAT(refused(good, {{{8}, nullptr}}), testing::HasSubstr("keyframe 8"));
  index.Restore({}, keyframes);  // a map saved without a vocabulary: grown on restore
  EXPECT_EQ(index.Save().grown_at, 2u);
  EXPECT_EQ(index.Query(*room[9], {}, 1).at(0).id.value, 9u);
  EXPECT_THAT(MessageOf(ErrorKind::kUsage,
                        [] {
                          PlaceSettings settings;
                          settings.shortlist = 0;
                          const PlaceIndex unmade(settings);
                        }),
              testing::HasSubstr("shortlist"));
}

TEST(PlaceIndex, IsAskedWhileItGrows) {
  const std::vector<SharedFrame> frames = Views(130, 1);
  PlaceIndex index;
  std::atomic<bool> done = false;
  std::atomic<int> asked = 0, wrong = 0;
  std::thread tracker([&] {
    while (!done) {
      const int size = index.size();
      const std::vector<PlaceMatch> found = index.Query(*frames[3], {}, 3);
      // Keyframe 3 is never removed, so it must be found.
      if (size > 4 && (found.empty() || found[0].id.value != 3)) ++wrong;
      if (size > 4 && index.Score(*frames[3], {3}) < 0.99) ++wrong;
      index.Save();
      index.MemoryBytes();
      ++asked;
    }
  });
  for (uint32_t i = 0; i < 130; ++i) {
    index.Add({i}, frames[i]);
    if (i > 20 && i % 3 == 0) index.Remove({i - 10});
  }
  while (asked < 20) std::this_thread::yield();
  done = true;
  tracker.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace alidade::place_index_test
