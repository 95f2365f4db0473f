// Tracks through images with known motion.
#include "alidade/dynamics/flow_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>
#include <vector>

#include "alidade/base/random.h"
#include "support/texture.h"
#include "support/vga_camera.h"

namespace alidade::flow_tracks_test {
namespace {

const cv::Size kSize(640, 480);
const cv::Mat& World() {
  static const cv::Mat world = MakeTexture(1000, 800, 3);
  return world;
}

// The image after the world has moved by `shift` pixels.
cv::Mat Seen(cv::Point2f shift, double noise = 2, uint64_t seed = 1) {
  const cv::Matx23d map(1, 0, shift.x - 150, 0, 1, shift.y - 150);
  cv::Mat image;
  cv::warpAffine(World(), image, map, kSize, cv::INTER_CUBIC);
  AddNoise(image, noise, seed);
  return image;
}

// OpenCV's corners.
std::vector<Keypoint> CornersOf(const cv::Mat& image) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(image, corners, 800, 0.01, 8);
  std::vector<Keypoint> keypoints;
  for (const cv::Point2f& corner : corners) {
    Keypoint keypoint;
    keypoint.x = keypoint.raw_x = corner.x;
    keypoint.y = keypoint.raw_y = corner.y;
    keypoints.push_back(keypoint);
  }
  return keypoints;
}

double Length(cv::Point2f p) { return std::hypot(p.x, p.y); }

class FlowTracksTest : public testing::Test {
 protected:
  void Begin(const cv::Mat& image) {
    tracks_.Advance(image);
    tracks_.Seed(CornersOf(image), kSize);
    ASSERT_GT(tracks_.tracks().size(), 200u);
  }
  FlowTracks tracks_;
};

TEST_F(FlowTracksTest, FollowAMotionOfPartsOfAPixel) {
  for (const cv::Point2f step : {cv::Point2f(0.3f, -0.7f), cv::Point2f(3.4f, 1.6f),
                                 cv::Point2f(-11.25f, 6.5f), cv::Point2f(0, 0)}) {
    tracks_ = {};
    Begin(Seen({}));
    const size_t begun = tracks_.tracks().size();
    for (int i = 1; i <= 5; ++i) tracks_.Advance(Seen(i * step, 2, i + 1));
    std::vector<double> errors;
    for (const FlowTrack& track : tracks_.tracks()) {
      ASSERT_EQ(track.length(), 6);
      errors.push_back(Length(track.at() - track.Before(5) - 5 * step));
    }
    // Tracks near the border leave the image.
    ASSERT_GT(static_cast<double>(errors.size()), 0.75 * static_cast<double>(begun)) << step;
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.2) << step;
    EXPECT_LT(errors[errors.size() * 9 / 10], 0.6) << step;
  }
}

TEST_F(FlowTracksTest, BeginAtCornersOfTheImageAndFollowThem) {
  const cv::Point2f step(3.4f, 1.6f);
  tracks_.Advance(Seen({}));
  const Camera camera = MakeVgaCamera();
  cv::Mat left_out = cv::Mat::zeros(4, 4, CV_8U);
  left_out.col(0).setTo(255);
  tracks_.SeedCorners(left_out, camera);
  const size_t begun = tracks_.tracks().size();
  EXPECT_GT(begun, 100u);
  for (const FlowTrack& track : tracks_.tracks())
    EXPECT_TRUE(cv::Rect(160, 0, 480, 480).contains(track.at())) << track.at();
  tracks_.SeedCorners(left_out, camera);
  EXPECT_EQ(tracks_.tracks().size(), begun);  // there is one in each cell already
  for (int i = 1; i <= 5; ++i) tracks_.Advance(Seen(i * step, 2, static_cast<uint64_t>(i) + 1));
  std::vector<double> errors;
  for (const FlowTrack& track : tracks_.tracks())
    errors.push_back(Length(track.at() - track.Before(5) - 5 * step));
  ASSERT_GT(2 * errors.size(), begun);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.2);
}

TEST_F(FlowTracksTest, TellWhereAPointWasInEveryFrameSince) {
  Begin(Seen({}));
  for (int i = 1; i <= 8; ++i) tracks_.Advance(Seen({2.0f * static_cast<float>(i), 0}));
  int right = 0;
  for (const FlowTrack& track : tracks_.tracks()) {
    bool all = true;
    for (int ago = 0; ago < track.length(); ++ago) {
      const cv::Point2f moved = track.at() - track.Before(ago);
      all &= Length(moved - cv::Point2f(2.0f * static_cast<float>(ago), 0)) < 0.6;
    }
    right += all;
  }
  EXPECT_GT(right, 0.9 * static_cast<double>(tracks_.tracks().size()));
}

TEST_F(FlowTracksTest, NoneAreLeftAfterACut) {
  Begin(Seen({}));
  const size_t begun = tracks_.tracks().size();
  cv::Mat other = MakeTexture(kSize.width, kSize.height, 77);
  tracks_.Advance(other);
  // A few corners match something similar by chance.
  EXPECT_LT(static_cast<double>(tracks_.tracks().size()), 0.1 * static_cast<double>(begun));
}

TEST_F(FlowTracksTest, NoneAreLeftWhereThePictureIsPlain) {
  Begin(Seen({}));
  tracks_.Advance(cv::Mat(kSize, CV_8U, cv::Scalar(90)));
  EXPECT_LT(tracks_.tracks().size(), 10u);
  tracks_.Advance(Seen({}));  // and it recovers
  tracks_.Seed(CornersOf(Seen({})), kSize);
  EXPECT_GT(tracks_.tracks().size(), 200u);
}

TEST_F(FlowTracksTest, ThePartThatIsCoveredIsDropped) {
  Begin(Seen({}));
  cv::Mat covered = Seen({});
  const cv::Rect cover(200, 100, 200, 250);
  MakeTexture(cover.width, cover.height, 88).copyTo(covered(cover));
  int before = 0, after = 0;
  const cv::Rect2f inside(220, 120, 160, 210);
  for (const FlowTrack& track : tracks_.tracks()) before += inside.contains(track.at());
  tracks_.Advance(covered);
  for (const FlowTrack& track : tracks_.tracks()) after += inside.contains(track.Before(1));
  ASSERT_GT(before, 20);
  EXPECT_LT(after, 0.2 * before);
}

TEST_F(FlowTracksTest, RememberNoMoreThanTheHistory) {
  Begin(Seen({}));
  for (int i = 0; i < FlowTracks::kHistory + 8; ++i) tracks_.Advance(Seen({}, 2, i));
  ASSERT_GT(tracks_.tracks().size(), 200u);
  for (const FlowTrack& track : tracks_.tracks()) EXPECT_EQ(track.length(), FlowTracks::kHistory);
}

TEST_F(FlowTracksTest, AreNotBegunWhereThereIsOne) {
  const cv::Mat image = Seen({});
  Begin(image);
  const size_t begun = tracks_.tracks().size();
  for (int i = 0; i < 3; ++i) {
    tracks_.Seed(CornersOf(image), kSize);
    EXPECT_EQ(tracks_.tracks().size(), begun);
  }
}

TEST_F(FlowTracksTest, AreBegunWhereTheyHaveLeft) {
  Begin(Seen({}));
  for (int i = 1; i <= 10; ++i) tracks_.Advance(Seen({12.0f * static_cast<float>(i), 0}));
  int before = 0, after = 0;
  for (const FlowTrack& track : tracks_.tracks()) before += track.at().x < 90;
  tracks_.Seed(CornersOf(Seen({120, 0})), kSize);
  for (const FlowTrack& track : tracks_.tracks()) after += track.at().x < 90;
  EXPECT_LT(before, 5);
  EXPECT_GT(after, 20);
}

TEST_F(FlowTracksTest, NamesAreNeverGivenTwiceAndGrow) {
  Begin(Seen({}));
  std::set<uint32_t> ids;
  uint32_t most = 0;
  for (const FlowTrack& track : tracks_.tracks()) {
    EXPECT_TRUE(ids.insert(track.id).second);
    most = std::max(most, track.id);
  }
  tracks_.Advance(MakeTexture(kSize.width, kSize.height, 77));
  tracks_.Advance(Seen({}));
  tracks_.Seed(CornersOf(Seen({})), kSize);
  for (size_t i = 1; i < tracks_.tracks().size(); ++i)
    EXPECT_GT(tracks_.tracks()[i].id, tracks_.tracks()[i - 1].id);
  EXPECT_GT(tracks_.tracks().back().id, most);
}

TEST_F(FlowTracksTest, AreTheSameRunAfterRun) {
  const auto run = [] {
    FlowTracks tracks;
    std::vector<std::vector<cv::Point2f>> all;
    for (int i = 0; i < 6; ++i) {
      const cv::Mat image = Seen({1.7f * static_cast<float>(i), 0.4f}, 4, i);
      tracks.Advance(image);
      tracks.Seed(CornersOf(image), kSize);
    }
    for (const FlowTrack& track : tracks.tracks())
      all.emplace_back(track.path.begin(), track.path.end());
    return all;
  };
  EXPECT_EQ(run(), run());
}

TEST(FlowTracksOfOddPictures, StayInThem) {
  const cv::Mat world = MakeTexture(300, 300, 9);
  FlowTracks tracks;
  for (int i = 0; i < 10; ++i) {
    const cv::Mat image = world(cv::Rect(3 * i, 2 * i, 201, 151)).clone();
    tracks.Advance(image);
    for (const FlowTrack& track : tracks.tracks()) {
      EXPECT_GE(track.at().x, 0);
      EXPECT_GE(track.at().y, 0);
      EXPECT_LE(track.at().x, 200);
      EXPECT_LE(track.at().y, 150);
    }
    tracks.Seed(CornersOf(image), image.size());
  }
  EXPECT_GT(tracks.tracks().size(), 15u);
}

}  // namespace
}  // namespace alidade::flow_tracks_test
