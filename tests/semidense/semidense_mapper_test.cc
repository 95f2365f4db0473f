#include "alidade/semidense/semidense_mapper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/map/correction.h"
#include "support/dense_world.h"

namespace alidade::semidense_mapper_test {
namespace {

struct Score {
  size_t pixels = 0;
  double median = NAN;    // relative error of depth
  double within_5 = NAN;  // share
};

class SemiDenseMapperTest : public testing::Test {
 protected:
  SemiDenseMapperTest() { settings_.enabled = true; }

  void Look(const std::vector<Se3>& way, const DenseWorldSettings& picture = {}) {
    for (const Se3& pose : way) {
      DenseWorldSettings own = picture;
      own.noise_seed = views_.size() + 1;
      views_.push_back(world_.Look(pose, own));
    }
    ids_ = EnterViews(views_, world_.camera(), store_);
  }
  std::shared_ptr<const Picture> PictureOf(size_t view) const {
    return std::make_shared<Picture>(Picture{views_[view].image, {}, views_[view].depth});
  }
  // Keeps all pictures and processes everything.
  SemiDenseReport MapAll() {
    SemiDenseMapper mapper(store_, world_.camera(), settings_);
    for (size_t i = 0; i < ids_.size(); ++i) mapper.Keep(ids_[i], PictureOf(i));
    mapper.Finish();
    return mapper.report();
  }
  const DepthMap* DepthOf(size_t view) const {
    snapshot_ = store_.Snapshot();
    return snapshot_.Find(ids_[view])->depth.get();
  }
  Score ScoreOf(size_t view, double unit = 1) const {
    std::vector<double> errors;
    for (const DepthPixel& pixel : DepthOf(view)->pixels) {
      const double truth = views_[view].depth.at<float>(pixel.y, pixel.x);
      errors.push_back(std::abs(unit / pixel.inverse_depth - truth) / truth);
    }
    Score score;
    score.pixels = errors.size();
    if (errors.empty()) return score;
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    score.median = errors[errors.size() / 2];
    const auto good =
        std::count_if(errors.begin(), errors.end(), [](double error) { return error < 0.05; });
    score.within_5 = static_cast<double>(good) / static_cast<double>(errors.size());
    return score;
  }
  size_t EdgesOf(size_t view) const {
    return GradientImageMaker(world_.camera(), settings_.min_gradient, settings_.gradient_weight)
        .Make(*PictureOf(view))
        .edges.size();
  }
  size_t PixelsInAll() const {
    size_t pixels = 0;
    for (size_t i = 0; i < ids_.size(); ++i) pixels += DepthOf(i) ? DepthOf(i)->pixels.size() : 0;
    return pixels;
  }

  const DenseWorld world_;
  SemiDenseSettings settings_;
  MapStore store_;
  std::vector<DenseView> views_;
  std::vector<KeyFrameId> ids_;
  mutable MapSnapshot snapshot_;
};

TEST_F(SemiDenseMapperTest, FindsTheShapeOfThePlace) {
  Look(WayBeforeTheWall(9, 0.08));
  const SemiDenseReport report = MapAll();
  EXPECT_EQ(report.keyframes, 9);
  EXPECT_GT(report.search.searches, report.pixels);
  for (size_t i = 0; i < ids_.size(); ++i) {
    const Score score = ScoreOf(i);
    EXPECT_GT(score.pixels, EdgesOf(i) / 2) << i;
    EXPECT_LT(score.median, 0.005) << i;
    EXPECT_GT(score.within_5, 0.95) << i;
  }
}

TEST_F(SemiDenseMapperTest, PixelsAreInOrderAndWithinThePicture) {
  Look(WayBeforeTheWall(6, 0.08));
  MapAll();
  const DepthMap& depth = *DepthOf(2);
  EXPECT_EQ(depth.width, 320);
  EXPECT_EQ(depth.height, 240);
  for (size_t i = 0; i < depth.pixels.size(); ++i) {
    const DepthPixel& p = depth.pixels[i];
    EXPECT_TRUE(p.x < 320 && p.y < 240);
    EXPECT_GT(p.sigma, 0);
    EXPECT_TRUE(std::isfinite(p.inverse_depth) && p.inverse_depth > 0);
    if (i == 0) continue;
    const DepthPixel& before = depth.pixels[i - 1];
    EXPECT_TRUE(before.y < p.y || (before.y == p.y && before.x < p.x));
  }
}

TEST_F(SemiDenseMapperTest, IsTheSameWithOneThreadOrThree) {
  Look(WayBeforeTheWall(6, 0.08));
  SetThreadCount(1);
  MapAll();
  const std::vector<DepthPixel> one = DepthOf(3)->pixels;
  SetThreadCount(3);
  MapAll();
  const std::vector<DepthPixel> three = DepthOf(3)->pixels;
  SetThreadCount(0);
  ASSERT_EQ(one.size(), three.size());
  ASSERT_GT(one.size(), 1000u);
  for (size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(std::memcmp(&one[i].inverse_depth, &three[i].inverse_depth, sizeof(float)), 0);
    ASSERT_EQ(std::memcmp(&one[i].sigma, &three[i].sigma, sizeof(float)), 0);
  }
}

TEST_F(SemiDenseMapperTest, WorksAFewKeyframesBehindNewestFirst) {
  Look(WayBeforeTheWall(8, 0.08));
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  for (size_t i = 0; i < 6; ++i) mapper.Keep(ids_[i], PictureOf(i));
  mapper.Process();  // the last of the first four, which are due
  EXPECT_EQ(mapper.report().most_behind, 4);
  EXPECT_TRUE(DepthOf(3));
  EXPECT_FALSE(DepthOf(2));
  EXPECT_FALSE(DepthOf(4));
  mapper.Process();
  EXPECT_TRUE(DepthOf(2));
  mapper.Keep(ids_[6], PictureOf(6));
  mapper.Process();
  EXPECT_TRUE(DepthOf(4));
  mapper.Finish();
  for (size_t i = 0; i < 7; ++i) EXPECT_TRUE(DepthOf(i)) << i;
  EXPECT_FALSE(DepthOf(7));  // no picture was kept
}

TEST_F(SemiDenseMapperTest, AKeyframeIsDoneAgainWhenItsNeighboursMoved) {
  Look(WayBeforeTheWall(7, 0.08));
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  for (size_t i = 0; i < ids_.size(); ++i) mapper.Keep(ids_[i], PictureOf(i));
  mapper.Finish();
  const int before = mapper.report().keyframes;
  mapper.Process();
  mapper.Finish();
  EXPECT_EQ(mapper.report().keyframes, before);
  store_.Commit([&](MapCommit& commit) {
    commit.Edit(ids_[3])->T_camera_world.t += Eigen::Vector3d(0.02, 0, 0);
  });
  mapper.Process();
  EXPECT_EQ(mapper.report().keyframes, before + 1);
  mapper.Finish();
  EXPECT_GT(mapper.report().keyframes, before + 1);
  const int settled = mapper.report().keyframes;
  mapper.Finish();
  EXPECT_EQ(mapper.report().keyframes, settled);
}

TEST_F(SemiDenseMapperTest, AfterALoopMovedKeyframesAreDoneBesideNewOnes) {
  Look(WayBeforeTheWall(8, 0.08));
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  for (size_t i = 0; i < 5; ++i) {
    mapper.Keep(ids_[i], PictureOf(i));
    mapper.Process();
  }
  EXPECT_EQ(mapper.report().keyframes, 3);
  store_.Commit([&](MapCommit& commit) {
    commit.Edit(ids_[1])->T_camera_world.t += Eigen::Vector3d(0.02, 0, 0);
    commit.CountCorrection();
  });
  mapper.Keep(ids_[5], PictureOf(5));
  mapper.Process();
  EXPECT_EQ(mapper.report().keyframes, 5);
}

// A loop closure: the whole map is moved, rotated and scaled.
TEST_F(SemiDenseMapperTest, DepthFollowsItsKeyframeInPlaceAndScale) {
  Look(WayBeforeTheWall(7, 0.08));
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  for (size_t i = 0; i < ids_.size(); ++i) mapper.Keep(ids_[i], PictureOf(i));
  mapper.Finish();
  const int before = mapper.report().keyframes;
  const Se3 T_new_old = CameraAt({3, 2, 1}, 0.8);
  store_.Commit([&](MapCommit& commit) {
    std::vector<KeyFrameCorrection> corrections;
    for (KeyFrameId id : ids_) {
      Se3 pose = commit.Find(id)->T_camera_world * T_new_old.Inverse();
      pose.t *= 1.25;
      corrections.push_back({id, pose, 1.25});
    }
    CommitCorrections(commit, corrections);
  });
  const KeyFrame keyframe = *store_.Snapshot().Find(ids_[3]);
  EXPECT_NEAR(keyframe.scale / keyframe.depth->scale, 1.25, 1e-12);
  // Nothing is recomputed, because baselines scale with the depth; the next check agrees.
  mapper.Finish();
  EXPECT_EQ(mapper.report().keyframes, before);
  const Score score = ScoreOf(3, 1 / 1.25);
  EXPECT_LT(score.median, 0.005);
  EXPECT_GT(score.pixels, EdgesOf(3) / 2);
}

TEST_F(SemiDenseMapperTest, ACulledKeyframeDropsItsDepth) {
  Look(WayBeforeTheWall(7, 0.08));
  MapAll();
  store_.Commit([&](MapCommit& commit) { commit.Remove(ids_[3]); });
  EXPECT_EQ(store_.Snapshot().Find(ids_[3]), nullptr);
  MapAll();  // continues without it
  EXPECT_GT(ScoreOf(2).pixels, EdgesOf(2) / 2);
}

TEST_F(SemiDenseMapperTest, TwoKeyframesAreNotEnough) {
  Look(WayBeforeTheWall(2, 0.1));
  MapAll();
  EXPECT_EQ(PixelsInAll(), 0u);
}

TEST_F(SemiDenseMapperTest, ATurnOnTheSpotInventsNothing) {
  std::vector<Se3> way;
  for (int i = 0; i < 8; ++i) way.push_back(CameraAt({0, 0, 0}, 0.02 * i));
  Look(way);
  MapAll();
  EXPECT_EQ(PixelsInAll(), 0u);
}

TEST_F(SemiDenseMapperTest, ACameraThatTremblesInventsNothing) {
  std::vector<Se3> way;
  for (int i = 0; i < 8; ++i) way.push_back(CameraAt({0.002 * (i % 2), 0.002 * (i % 3), 0}));
  Look(way);
  MapAll();
  EXPECT_EQ(PixelsInAll(), 0u);
}

TEST_F(SemiDenseMapperTest, WhatIsWrittenOfBlurredPicturesIsRight) {
  Look(WayBeforeTheWall(8, 0.08));
  for (size_t i = 1; i < views_.size(); i += 2) {
    cv::blur(views_[i].image, views_[i].image, cv::Size(15, 1));
  }
  MapAll();
  for (size_t i = 0; i < ids_.size(); ++i) {
    if (DepthOf(i)->pixels.size() < 100) continue;
    EXPECT_LT(ScoreOf(i).median, 0.02) << i;
    EXPECT_GT(ScoreOf(i).within_5, 0.85) << i;
  }
}

TEST_F(SemiDenseMapperTest, WhatIsWrittenOfSaturatedPicturesIsRight) {
  Look(WayBeforeTheWall(8, 0.08), {.gain = 2.5, .offset = -60});
  MapAll();
  for (size_t i = 0; i < ids_.size(); ++i) {
    if (DepthOf(i)->pixels.size() < 100) continue;
    EXPECT_LT(ScoreOf(i).median, 0.01) << i;
  }
}

TEST_F(SemiDenseMapperTest, BlackAndWhitePicturesHaveNoDepth) {
  Look(WayBeforeTheWall(6, 0.08));
  for (size_t i = 0; i < views_.size(); ++i) views_[i].image = i % 2 ? uint8_t{255} : uint8_t{0};
  MapAll();
  EXPECT_EQ(PixelsInAll(), 0u);
}

TEST_F(SemiDenseMapperTest, WhatMovesHasNoDepth) {
  Look(WayBeforeTheWall(7, 0.08));
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  cv::Mat mask(world_.camera().height, world_.camera().width, CV_8U, cv::Scalar(0));
  mask.colRange(100, 200) = 255;
  for (size_t i = 0; i < ids_.size(); ++i) {
    mapper.Keep(ids_[i], std::make_shared<Picture>(Picture{views_[i].image, {}, {}, mask}));
  }
  mapper.Finish();
  EXPECT_GT(DepthOf(3)->pixels.size(), 1000u);
  for (const DepthPixel& pixel : DepthOf(3)->pixels) EXPECT_TRUE(pixel.x < 100 || pixel.x >= 200);
}

TEST_F(SemiDenseMapperTest, ASensorsDepthIsFusedForComparison) {
  settings_.from_sensor = true;
  Look(WayBeforeTheWall(7, 0.08));
  MapAll();
  const Score score = ScoreOf(3);
  EXPECT_GT(score.pixels, EdgesOf(3) / 2);
  EXPECT_LT(score.median, 0.001);
}

TEST_F(SemiDenseMapperTest, LetsTheOldestGoWhenTooManyWait) {
  std::vector<Se3> way;
  for (int i = 0; i < 8; ++i) way.push_back({Eigen::Matrix3d::Identity(), {-0.04 * i, 0, 0}});
  Look(way);
  settings_.max_waiting = 5;
  std::vector<std::string> warnings;
  SetWarningListener([&](const std::string& warning) { warnings.push_back(warning); });
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  for (size_t i = 0; i < 4; ++i) mapper.Keep(ids_[i], PictureOf(i));
  mapper.Process();  // the newest with two keyframes behind it; 0, 2 and 3 remain waiting
  for (size_t i = 4; i < 8; ++i) mapper.Keep(ids_[i], PictureOf(i));
  mapper.Finish();
  SetWarningListener(nullptr);
  EXPECT_EQ(mapper.report().let_go, 2);  // keyframes 0 and 2
  EXPECT_EQ(warnings.size(), 1u);
  for (size_t i = 0; i < 8; ++i) EXPECT_EQ(DepthOf(i) == nullptr, i == 0 || i == 2) << i;
}

TEST_F(SemiDenseMapperTest, TurnsPicturesAwayThatNobodyTakesIn) {
  std::vector<Se3> way;
  for (int i = 0; i < 8; ++i) way.push_back({Eigen::Matrix3d::Identity(), {-0.04 * i, 0, 0}});
  Look(way);
  settings_.max_waiting = 5;
  std::vector<std::weak_ptr<const Picture>> pictures;
  SetWarningListener([](const std::string&) {});
  SemiDenseMapper mapper(store_, world_.camera(), settings_);
  for (size_t i = 0; i < 8; ++i) {
    const auto picture = PictureOf(i);
    pictures.push_back(picture);
    mapper.Keep(ids_[i], picture);
  }
  for (size_t i = 0; i < 8; ++i) EXPECT_EQ(pictures[i].expired(), i < 3) << i;
  mapper.Finish();
  SetWarningListener(nullptr);
  EXPECT_EQ(mapper.report().let_go, 3);
}

}  // namespace
}  // namespace alidade::semidense_mapper_test
