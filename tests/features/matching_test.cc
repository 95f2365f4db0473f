#include "alidade/features/matching.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "alidade/base/parallel.h"
#include "alidade/base/random.h"

namespace alidade::matching_test {
namespace {

// b has noisy copies of a's descriptors in another order, and some additional ones.
struct Pair {
  Frame a, b;
  std::vector<int> partner;  // index in b of each keypoint of a
};

Pair MakePair(int count, double flip, uint64_t seed) {
  Random random(seed);
  const auto descriptor = [&] {
    Descriptor d;
    for (uint64_t& w : d.words) w = (static_cast<uint64_t>(random.Next()) << 32) | random.Next();
    return d;
  };
  Pair pair;
  pair.partner = random.Sample(count, count);
  pair.b.keypoints.resize(count + 50);
  pair.b.descriptors.resize(count + 50);
  for (int i = 0; i < count; ++i) {
    Keypoint k;
    k.x = static_cast<float>(random.Uniform(0, 640));
    k.y = static_cast<float>(random.Uniform(0, 480));
    k.level = static_cast<int>(random.Below(4));
    k.angle = static_cast<float>(random.Uniform(-3, 3));
    pair.a.keypoints.push_back(k);
    pair.a.descriptors.push_back(descriptor());
    Descriptor d = pair.a.descriptors.back();
    for (int bit = 0; bit < 256; ++bit) {
      if (random.Uniform() < flip) d.words[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    k.x += static_cast<float>(random.Uniform(-10, 10));
    k.y += static_cast<float>(random.Uniform(-10, 10));
    pair.b.keypoints[pair.partner[i]] = k;
    pair.b.descriptors[pair.partner[i]] = d;
  }
  for (int i = count; i < count + 50; ++i) pair.b.descriptors[i] = descriptor();
  for (Frame* f : {&pair.a, &pair.b}) f->grid = KeypointGrid(f->keypoints, 640, 480);
  return pair;
}

cv::Mat AsMat(const std::vector<Descriptor>& descriptors) {
  cv::Mat mat(static_cast<int>(descriptors.size()), 32, CV_8UC1);
  for (int i = 0; i < mat.rows; ++i) std::memcpy(mat.ptr(i), &descriptors[i], 32);
  return mat;
}

TEST(HammingDistance, IsOpenCvs) {
  const Pair pair = MakePair(50, 0.3, 1);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(
        HammingDistance(pair.a.descriptors[i], pair.b.descriptors[i]),
        cv::norm(AsMat({pair.a.descriptors[i]}), AsMat({pair.b.descriptors[i]}), cv::NORM_HAMMING));
  }
}

TEST(MatchBruteForce, IsOpenCvsMatcherWithRatioAndCrossCheck) {
  // Half of the bits flip in the worst case: many matches are wrong or rejected.
  for (double flip : {0.05, 0.25, 0.33}) {
    const Pair pair = MakePair(300, flip, 2);
    const MatchSettings settings{
        .max_distance = 90, .ratio = 0.85, .cross_check = true, .check_orientation = false};
    std::map<int, std::pair<int, int>> theirs;
    std::vector<std::vector<cv::DMatch>> forth, back;
    const cv::BFMatcher matcher(cv::NORM_HAMMING);
    matcher.knnMatch(AsMat(pair.a.descriptors), AsMat(pair.b.descriptors), forth, 2);
    matcher.knnMatch(AsMat(pair.b.descriptors), AsMat(pair.a.descriptors), back, 1);
    for (const auto& m : forth) {
      if (m[0].distance > 90 || m[0].distance >= 0.85 * m[1].distance) continue;
      if (back[m[0].trainIdx][0].trainIdx != m[0].queryIdx) continue;
      theirs[m[0].queryIdx] = {m[0].trainIdx, static_cast<int>(m[0].distance)};
    }
    std::map<int, std::pair<int, int>> ours;
    int previous = -1;
    for (const IndexMatch& m : MatchBruteForce(pair.a, pair.b, settings)) {
      EXPECT_GT(m.a, previous);
      previous = m.a;
      ours[m.a] = {m.b, m.distance};
    }
    EXPECT_EQ(ours, theirs);
    EXPECT_GT(ours.size(), 20u);
  }
}

TEST(MatchBruteForce, GivesTheSameWithOneAndWithManyThreads) {
  const Pair pair = MakePair(700, 0.2, 3);
  const auto indices = [&] {
    std::vector<int> all;
    for (const IndexMatch& m : MatchBruteForce(pair.a, pair.b, {.max_distance = 100})) {
      all.insert(all.end(), {m.a, m.b, m.distance});
    }
    return all;
  };
  SetThreadCount(1);
  const std::vector<int> alone = indices();
  SetThreadCount(3);
  EXPECT_EQ(indices(), alone);
  SetThreadCount(0);
}

TEST(MatchSubsets, LooksOnlyAtTheKeypointsListed) {
  const Pair pair = MakePair(100, 0.05, 4);
  const std::vector<int> of_a = {3, 17, 40, 77};
  const std::vector<int> of_b = {pair.partner[17], pair.partner[40], pair.partner[50],
                                 pair.partner[3]};
  const std::vector<IndexMatch> matches = MatchSubsets(pair.a, of_a, pair.b, of_b);
  std::map<int, int> found;
  for (const IndexMatch& m : matches) found[m.a] = m.b;
  EXPECT_EQ(found, (std::map<int, int>{{3, of_b[3]}, {17, of_b[0]}, {40, of_b[1]}}));
}

TEST(MatchWindow, FindsPartnersNearTheGuessAndNoneFurtherOff) {
  const Pair pair = MakePair(400, 0.1, 5);
  std::vector<Eigen::Vector2f> guess;
  for (const Keypoint& k : pair.a.keypoints) guess.emplace_back(k.x, k.y);
  const std::vector<IndexMatch> matches = MatchWindow(pair.a, pair.b, guess, 11);
  for (const IndexMatch& m : matches) EXPECT_EQ(m.b, pair.partner[m.a]);
  EXPECT_GT(matches.size(), 390u);
  for (const IndexMatch& m : MatchWindow(pair.a, pair.b, guess, 5)) {
    EXPECT_LE(std::abs(pair.b.keypoints[m.b].x - guess[m.a].x()), 5);
    EXPECT_LE(std::abs(pair.b.keypoints[m.b].y - guess[m.a].y()), 5);
  }
  for (Eigen::Vector2f& g : guess) g.x() += 100;
  EXPECT_LT(MatchWindow(pair.a, pair.b, guess, 11).size(), 5u);
}

TEST(Matching, OfNothingIsNothing) {
  const Pair pair = MakePair(10, 0.1, 6);
  EXPECT_TRUE(MatchBruteForce(pair.a, Frame()).empty());
  EXPECT_TRUE(MatchBruteForce(Frame(), pair.b).empty());
  EXPECT_TRUE(MatchWindow(Frame(), pair.b, {}, 10).empty());
  EXPECT_TRUE(ConsistentTurns({}).empty());
}

TEST(ConsistentTurns, KeepsThePeaksAlsoAcrossTheEndsOfTheCircle) {
  Random random(7);
  std::vector<float> turns;
  for (int i = 0; i < 200; ++i) {
    // Rotations around half a turn, given as +π and -π, and around the full circle.
    const double turn = std::numbers::pi + random.Uniform(-0.1, 0.1);
    turns.push_back(static_cast<float>(i % 3 == 0 ? turn - 2 * std::numbers::pi : turn));
  }
  for (int i = 0; i < 40; ++i) turns.push_back(static_cast<float>(random.Uniform(-2.5, 2.5)));
  const std::vector<bool> keep = ConsistentTurns(turns);
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(keep[i]) << turns[i];
  int wrong = 0;
  for (int i = 200; i < 240; ++i) wrong += keep[i];
  EXPECT_LE(wrong, 6);
}

}  // namespace
}  // namespace alidade::matching_test
