#include "alidade/view/cloud_picture.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "alidade/base/random.h"

namespace alidade::cloud_picture_test {
namespace {

const std::array<uint8_t, 3> kRed = {255, 0, 0}, kBlue = {0, 0, 255};  // red green blue

// A camera at the origin that looks along z.
CloudScene SceneOf(const Cloud& cloud) { return {cloud, {{Se3()}}}; }

void Add(CloudScene& scene, const Eigen::Vector3f& p, const std::array<uint8_t, 3>& rgb) {
  scene.cloud.points.push_back(p);
  scene.cloud.colors.push_back(rgb);
}

// A square of 2 m at `z`, facing the camera.
void AddWall(CloudScene& scene, float z, const std::array<uint8_t, 3>& rgb) {
  for (int y = -80; y <= 80; ++y) {
    for (int x = -80; x <= 80; ++x)
      Add(scene, {static_cast<float>(x) / 80, static_cast<float>(y) / 80, z}, rgb);
  }
}

int Count(const cv::Mat& picture, const std::array<uint8_t, 3>& rgb) {
  cv::Mat mask;
  const cv::Scalar color(rgb[2], rgb[1], rgb[0]);
  cv::inRange(picture, color, color, mask);
  return cv::countNonZero(mask);
}

TEST(CloudPicture, WhatIsNearHidesWhatIsBehindIt) {
  for (const bool near_first : {true, false}) {
    CloudScene scene = SceneOf({});
    AddWall(scene, near_first ? 2.f : 3.f, near_first ? kRed : kBlue);
    AddWall(scene, near_first ? 3.f : 2.f, near_first ? kBlue : kRed);
    const cv::Mat picture = DrawCloud(scene, CloudView::kFront);
    EXPECT_EQ(picture.type(), CV_8UC3);
    EXPECT_EQ(picture.size(), cv::Size(1200, 800));
    EXPECT_GT(Count(picture, kRed), 1000);
    EXPECT_LT(Count(picture(cv::Rect(500, 300, 200, 200)), kBlue),
              Count(picture(cv::Rect(500, 300, 200, 200)), kRed) / 4);
  }
}

TEST(CloudPicture, AllOfThePlaceIsInItAndFillsIt) {
  Random random(3);
  CloudScene scene = SceneOf({});
  for (int i = 0; i < 3000; ++i) {
    const auto at = [&](double extent) {
      return static_cast<float>(extent * (random.Uniform(0, 1) - 0.5));
    };
    Add(scene, {at(3), at(2), 2 + at(2)}, kRed);
  }
  CloudPictureSettings all;
  all.least_percent = 0;
  for (const CloudView view :
       {CloudView::kBehind, CloudView::kFront, CloudView::kSide, CloudView::kAbove}) {
    const cv::Mat picture = DrawCloud(scene, view, all);
    cv::Mat drawn;
    cv::inRange(picture, cv::Scalar(0, 0, 100), cv::Scalar(80, 80, 255), drawn);
    const cv::Rect box = cv::boundingRect(drawn);
    EXPECT_GT(box.x, 0);
    EXPECT_GT(box.y, 0);
    EXPECT_LT(box.br().x, picture.cols);
    EXPECT_LT(box.br().y, picture.rows);
    // The camera at the origin must be included, and the scene's aspect ratio differs from the
    // image's.
    EXPECT_TRUE(box.width > 0.5 * picture.cols || box.height > 0.5 * picture.rows);
  }
}

TEST(CloudPicture, AFewPointsFarOffDoNotMakeItSmall) {
  CloudScene scene = SceneOf({});
  AddWall(scene, 2, kRed);
  const int before = Count(DrawCloud(scene, CloudView::kFront), kRed);
  for (int i = 0; i < 10; ++i) Add(scene, {1000.f, 50.f * static_cast<float>(i), 2000.f}, kBlue);
  EXPECT_GT(Count(DrawCloud(scene, CloudView::kFront), kRed), 0.8 * before);
}

TEST(CloudPicture, WallsSeenFromTheirOtherSideDoNotHideTheRoom) {
  CloudScene scene = SceneOf({});
  const Se3 backwards{ExpSo3({0, 3.141592653589793, 0}), Eigen::Vector3d::Zero()};
  scene.path[0].push_back(backwards);
  AddWall(scene, 3, kRed);
  AddWall(scene, -3, kBlue);  // between the wall and the virtual camera behind the first camera
  const cv::Mat picture = DrawCloud(scene, CloudView::kFront);
  EXPECT_GT(Count(picture, kRed), 1000);
  EXPECT_EQ(Count(picture, kBlue), 0);
  // After a camera has seen it from behind, as when moving around an object, it is shown.
  scene.path[0].push_back({Eigen::Matrix3d::Identity(), {0, 0, -4.5}});
  EXPECT_GT(Count(DrawCloud(scene, CloudView::kFront), kBlue), 100);
}

TEST(CloudPicture, WhatIsHardlyKnownIsLeftOut) {
  CloudScene scene = SceneOf({});
  AddWall(scene, 2, kRed);
  scene.cloud.sigmas.assign(scene.cloud.points.size(), 0.001f);
  AddWall(scene, 1.5f, kBlue);
  scene.cloud.sigmas.resize(scene.cloud.points.size(), 0.5f);
  const cv::Mat picture = DrawCloud(scene, CloudView::kFront);
  EXPECT_GT(Count(picture, kRed), 1000);
  EXPECT_EQ(Count(picture, kBlue), 0);
}

TEST(CloudPicture, OfNothingIsEmpty) {
  for (const CloudScene& scene : {CloudScene{}, CloudScene{{{{1, 2, 3}}, {}, {}, {}}, {}}}) {
    for (const CloudView view : {CloudView::kBehind, CloudView::kAbove}) {
      const cv::Mat picture = DrawCloud(scene, view);
      EXPECT_EQ(picture.size(), cv::Size(1200, 800));
    }
  }
}

}  // namespace
}  // namespace alidade::cloud_picture_test
