#include <gtest/gtest.h>

#include <limits>

#include "alidade/base/error.h"
#include "alidade/features/extractor.h"

namespace alidade::depth_test {
namespace {

Camera DepthCamera() {
  Camera camera = Camera::FromFieldOfView(64, 48, 60);
  camera.depth_factor = 5000;
  return camera;
}

Frame FrameWith(std::vector<Eigen::Vector2f> places) {
  Frame frame;
  frame.image = cv::Mat(48, 64, CV_8UC1, cv::Scalar(0));
  for (const Eigen::Vector2f& p : places) {
    Keypoint k;
    k.raw_x = p.x();
    k.raw_y = p.y();
    k.x = p.x() + 3;  // as if undistorted
    k.y = p.y() - 2;
    frame.keypoints.push_back(k);
  }
  return frame;
}

TEST(AttachDepth, ReadsIntegersAndMetresAtTheRawPosition) {
  const Camera camera = DepthCamera();
  cv::Mat integers(48, 64, CV_16UC1, cv::Scalar(10000)), metres(48, 64, CV_32FC1, cv::Scalar(2.f));
  integers.at<uint16_t>(20, 31) = 10100;
  metres.at<float>(20, 31) = 2.02f;
  for (const cv::Mat& depth : {integers, metres}) {
    Frame frame = FrameWith({{31.4f, 19.6f}, {0, 0}, {63.4f, 47.4f}});
    AttachDepth(depth, camera, frame);
    EXPECT_FLOAT_EQ(frame.keypoints[0].depth, 2.02f);
    EXPECT_FLOAT_EQ(frame.keypoints[1].depth, 2.f);
    EXPECT_FLOAT_EQ(frame.keypoints[2].depth, 2.f);
    EXPECT_NEAR(frame.keypoints[0].right_x, 34.4 - camera.bf() / 2.02, 1e-4);
  }
}

TEST(AttachDepth, WhatLiesBeyondTheSensorsRangeIsNoReading) {
  const Camera camera = DepthCamera();
  cv::Mat depth(48, 64, CV_32FC1, cv::Scalar(7.9f));
  depth(cv::Rect(32, 0, 32, 48)) = 8.1f;
  Frame frame = FrameWith({{10, 10}, {50, 10}});
  AttachDepth(depth, camera, frame, 8);
  EXPECT_FLOAT_EQ(frame.keypoints[0].depth, 7.9f);
  EXPECT_FALSE(frame.keypoints[1].has_depth());
  EXPECT_EQ(frame.keypoints[1].right_x, Keypoint::kNoDepth);
  AttachDepth(depth, camera, frame);  // no range limit
  EXPECT_FLOAT_EQ(frame.keypoints[1].depth, 8.1f);
}

// Depths in a wrong unit: the column in the right image would exceed what a map file accepts.
TEST(AttachDepth, WhatLiesInTheLensIsNoReading) {
  const Camera camera = DepthCamera();
  for (const float metres : {1e-30f, 1e-7f}) {
    const cv::Mat depth(48, 64, CV_32FC1, cv::Scalar(metres));
    Frame frame = FrameWith({{10, 10}});
    AttachDepth(depth, camera, frame);
    EXPECT_FALSE(frame.keypoints[0].has_depth());
    EXPECT_EQ(frame.keypoints[0].right_x, Keypoint::kNoDepth);
  }
}

TEST(AttachDepth, LeavesOutEdgesHolesAndNonsense) {
  const Camera camera = DepthCamera();
  cv::Mat depth(48, 64, CV_32FC1, cv::Scalar(2.f));
  depth.at<float>(10, 10) = 2.12f;  // 6 % farther: a depth discontinuity
  depth.at<float>(10, 20) = 2.08f;  // 4 %: a slanted surface
  depth.at<float>(10, 30) = 0;      // a hole
  depth.at<float>(10, 40) = std::numeric_limits<float>::quiet_NaN();
  depth.at<float>(10, 50) = -1;
  Frame frame = FrameWith(
      {{10, 10}, {11, 11}, {13, 10}, {20, 10}, {30, 10}, {31, 10}, {40, 10}, {41, 10}, {50, 10}});
  AttachDepth(depth, camera, frame);
  std::vector<bool> has;
  for (const Keypoint& k : frame.keypoints) has.push_back(k.has_depth());
  EXPECT_EQ(has, (std::vector<bool>{false, false, true, true, false, true, false, true, false}));
  EXPECT_EQ(frame.keypoints[0].right_x, Keypoint::kNoDepth);
}

TEST(AttachDepth, ForgetsAnEarlierDepth) {
  Frame frame = FrameWith({{10, 10}});
  AttachDepth(cv::Mat(48, 64, CV_32FC1, cv::Scalar(2.f)), DepthCamera(), frame);
  AttachDepth(cv::Mat(48, 64, CV_32FC1, cv::Scalar(0.f)), DepthCamera(), frame);
  EXPECT_FALSE(frame.keypoints[0].has_depth());
  EXPECT_EQ(frame.keypoints[0].right_x, Keypoint::kNoDepth);
}

TEST(AttachDepth, RefusesImagesOfAnotherSizeOrKind) {
  Frame frame = FrameWith({{10, 10}});
  EXPECT_THROW(AttachDepth(cv::Mat(48, 64, CV_8UC1), DepthCamera(), frame), Error);
  EXPECT_THROW(AttachDepth(cv::Mat(24, 32, CV_16UC1), DepthCamera(), frame), Error);
  EXPECT_THROW(AttachDepth(cv::Mat(48, 64, CV_16UC1), Camera::FromFieldOfView(64, 48, 60), frame),
               Error);
}

}  // namespace
}  // namespace alidade::depth_test
