// Covariances of poses compared with their errors, on a rendered room with exact poses.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "alidade/evaluation/motion_error.h"
#include "alidade/geometry/alignment.h"
#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade::quality_test {
namespace {

constexpr int kFrames = 60;
constexpr int kSettled = 20;  // frames
// One camera: the frames before this one are in a map of little parallax, whose errors are larger
// than the residuals tell (docs/concepts.md).
constexpr int kGrown = 60;
// Distance of the two frames of a pair: a third of a second. Consecutive frames use the same
// landmarks and share their errors, so the error between them is a third smaller than their
// covariances say.
constexpr int kGap = 10;

// One camera needs the larger image: at 320 × 240 its views differ by so few pixels that their
// residuals do not show the errors (docs/concepts.md).
RenderedFrames& TheRoom(Sensor sensor = Sensor::kStereo) {
  SynthSettings settings;
  if (sensor != Sensor::kMono) {
    settings.width = 320;
    settings.height = 240;
    settings.stereo = true;
  }
  return FramesOf(settings);
}

double MetersPerUnit(const Slam& slam, RenderedFrames& room) {
  std::vector<Eigen::Vector3d> truth, found;
  for (const FramePose& pose : slam.Trajectory()) {
    if (!pose.tracked) continue;
    found.push_back(pose.T_world_camera.t);
    truth.push_back(room.Pose(static_cast<int>(pose.index)).t);
  }
  return AlignPoints(truth, found, true).s;
}

class Quality : public testing::TestWithParam<Sensor> {
 protected:
  void ExpectErrorsOfTheSizeOfTheCovariance(bool align);
};

// Checks the motion between two frames, computed from their poses in the map; a common error of the
// map cancels. Its covariance is the sum of those of the poses. If the covariances are right, the
// root mean square of error / standard deviation is 1. All six parameters of the motion count
// equally.
void Quality::ExpectErrorsOfTheSizeOfTheCovariance(bool align) {
  RenderedFrames& room = TheRoom(GetParam());
  SlamSettings settings;
  settings.sensor = GetParam();
  settings.tracker.align = align;
  settings.fixed_parts = false;  // it needs the features of the first frames
  if (GetParam() != Sensor::kMono)
    settings.tracker.match_scale = settings.mapper.match_scale = settings.start.match_scale = 0.8;
  Slam slam(room.camera(), settings);
  std::vector<TrackResult> results;
  const int first = GetParam() == Sensor::kMono ? kGrown : 0;
  for (int i = 0; i < first + kFrames; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    results.push_back(slam.Track({frame.time, frame.image, frame.right, frame.depth}));
  }
  const double scale = GetParam() == Sensor::kMono ? MetersPerUnit(slam, room) : 1;

  double sum = 0;
  int count = 0;
  for (int i = first + kGap; i < first + kFrames; ++i) {
    const TrackResult &before = results[i - kGap], &now = results[i];
    if (before.quality.covariance.isZero() || now.quality.covariance.isZero()) continue;
    Se3 truth = room.Pose(i - kGap).Inverse() * room.Pose(i);
    truth.t /= scale;
    sum += MotionChiSquared({before.T_world_camera, before.quality.covariance},
                            {now.T_world_camera, now.quality.covariance}, truth);
    count += 6;
  }
  ASSERT_GE(count, 6 * 30);
  const double normalised = std::sqrt(sum / count);
  RecordProperty("normalised_error", std::to_string(normalised));
  EXPECT_GT(normalised, 0.7);
  EXPECT_LT(normalised, 1.5);
}

TEST_P(Quality, CovarianceIsTheSizeOfTheErrors) { ExpectErrorsOfTheSizeOfTheCovariance(false); }

TEST_P(Quality, CovarianceOfAlignedFramesIsTheSizeOfTheErrors) {
  ExpectErrorsOfTheSizeOfTheCovariance(true);
}

TEST_P(Quality, SaysHowMuchOfWhatIsExpectedWasFound) {
  RenderedFrames& room = TheRoom();
  SlamSettings settings;
  settings.sensor = GetParam();
  Slam slam(room.camera(), settings);
  int tracked = 0;
  for (int i = 0; i < kSettled; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    const TrackResult result = slam.Track({frame.time, frame.image, frame.right, frame.depth});
    const PoseQuality& quality = result.quality;
    if (result.state != TrackState::kTracking) {
      EXPECT_EQ(quality.expected, 0);
      EXPECT_TRUE(quality.covariance.isZero());
      continue;
    }
    ++tracked;
    EXPECT_EQ(quality.inliers, result.matches);
    EXPECT_GE(quality.expected, quality.inliers);
    EXPECT_DOUBLE_EQ(quality.found_share, static_cast<double>(quality.inliers) / quality.expected);
    if (result.keyframe && tracked == 1) continue;  // its pose is the identity by definition
    EXPECT_TRUE(quality.covariance.isApprox(quality.covariance.transpose()));
    EXPECT_GT(quality.covariance.diagonal().minCoeff(), 0);
    EXPECT_GT(quality.covariance.determinant(), 0);
  }
  EXPECT_GT(tracked, 5);
}

// Half of the image is blank: with fewer landmarks the covariance is larger.
TEST(QualityOfAView, FewerLandmarksMakeItLarger) {
  RenderedFrames& room = TheRoom();
  SlamSettings settings;
  settings.sensor = Sensor::kStereo;
  Slam slam(room.camera(), settings);
  TrackResult clear, veiled;
  for (int i = 0; i < 6; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    cv::Mat left = frame.image.clone(), right = frame.right.clone();
    if (i == 5) {  // the left half is blank
      for (cv::Mat* image : {&left, &right})
        (*image)(cv::Rect(0, 0, image->cols / 2, image->rows)).setTo(128);
    }
    (i == 5 ? veiled : clear) = slam.Track({frame.time, left, right, {}});
  }
  ASSERT_EQ(veiled.state, TrackState::kTracking) << veiled.reason();
  EXPECT_LT(veiled.quality.inliers, 0.8 * clear.quality.inliers);
  EXPECT_LT(veiled.quality.found_share, 0.8 * clear.quality.found_share);
  EXPECT_GT(veiled.quality.covariance.trace(), 1.5 * clear.quality.covariance.trace());
}

INSTANTIATE_TEST_SUITE_P(Sensors, Quality,
                         testing::Values(Sensor::kMono, Sensor::kStereo, Sensor::kRgbd),
                         [](const auto& sensor) { return std::string(NameOf(sensor.param)); });

}  // namespace
}  // namespace alidade::quality_test
