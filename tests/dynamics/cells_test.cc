// Cells of the image: positions, projection and depth.
#include "alidade/dynamics/cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/synth/recording.h"

namespace alidade::cells_test {
namespace {

Camera MakeCamera(int width, int height, bool distorted) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.82 * width;
  camera.cx = (width - 1) / 2.0 + 1.7;
  camera.cy = (height - 1) / 2.0 - 2.3;
  if (distorted) camera.distortion = {-0.22, 0.09, 0.0006, -0.0004, 0};
  camera.depth_factor = 5000;
  return camera;
}

struct Shape {
  int width, height;
  bool distorted;
};

class CellsOfAnySize : public testing::TestWithParam<Shape> {
 protected:
  Camera camera_ = MakeCamera(GetParam().width, GetParam().height, GetParam().distorted);
  Cells cells_{camera_};
};

TEST_P(CellsOfAnySize, EveryCentreLiesInItsCellAndInThePicture) {
  for (int i = 0; i < cells_.count(); ++i) {
    const cv::Point2f centre = cells_.Centre(i);
    ASSERT_EQ(cells_.At(centre.x, centre.y), i);
    ASSERT_GE(centre.x, -0.5f);
    ASSERT_LT(centre.x, static_cast<float>(camera_.width) - 0.5f);
    ASSERT_GE(centre.y, -0.5f);
    ASSERT_LT(centre.y, static_cast<float>(camera_.height) - 0.5f + cells_.size() / 2);
  }
}

TEST_P(CellsOfAnySize, EveryPixelIsHalfACellOrLessFromTheCentreOfItsCell) {
  for (int y = 0; y < camera_.height; ++y) {
    for (int x = 0; x < camera_.width; ++x) {
      const auto u = static_cast<float>(x), v = static_cast<float>(y);
      const cv::Point2f off = cells_.Centre(cells_.At(u, v)) - cv::Point2f(u, v);
      ASSERT_LE(std::abs(off.x), cells_.size() / 2 + 1e-3f) << x;
      // Rows need not divide the image exactly: up to half a cell remains at the bottom.
      ASSERT_LE(std::abs(off.y), cells_.size() + 1e-3f) << y;
    }
  }
}

TEST_P(CellsOfAnySize, WhatLiesOnTheRayOfACellIsShownByIt) {
  for (int i = 0; i < cells_.count(); ++i) {
    if (cells_.Centre(i).y >= static_cast<float>(camera_.height) - 0.5f) continue;
    for (double depth : {0.05, 1.0, 30.0}) ASSERT_EQ(cells_.Project(depth * cells_.Ray(i)), i);
    ASSERT_DOUBLE_EQ(cells_.Ray(i).z(), 1);
  }
}

TEST_P(CellsOfAnySize, WhatIsOutsideThePictureIsInTheNearestCell) {
  const auto far = static_cast<float>(2 * camera_.width);
  EXPECT_EQ(cells_.At(-far, -far), 0);
  EXPECT_EQ(cells_.At(far, -far), cells_.columns() - 1);
  EXPECT_EQ(cells_.At(-far, far), cells_.count() - cells_.columns());
  EXPECT_EQ(cells_.At(far, far), cells_.count() - 1);
}

TEST_P(CellsOfAnySize, WhatIsBehindOrBesideTheCameraIsShownByNone) {
  EXPECT_EQ(cells_.Project({0, 0, -1}), -1);
  EXPECT_EQ(cells_.Project({0, 0, 0}), -1);
  EXPECT_EQ(cells_.Project({1, 0, 0}), -1);
  EXPECT_EQ(cells_.Project({5, 0, 1}), -1);
  EXPECT_EQ(cells_.Project({0, -5, 1}), -1);
  const double nan = std::nan("");
  EXPECT_EQ(cells_.Project({nan, 0, 1}), -1);
  EXPECT_EQ(cells_.Project({0, 0, nan}), -1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, CellsOfAnySize,
                         testing::Values(Shape{640, 480, false}, Shape{640, 480, true},
                                         Shape{752, 480, true}, Shape{401, 303, true},
                                         Shape{333, 250, false}, Shape{100, 37, false}),
                         [](const testing::TestParamInfo<Shape>& sized) {
                           return std::to_string(sized.param.width) + "x" +
                                  std::to_string(sized.param.height) +
                                  (sized.param.distorted ? "Distorted" : "");
                         });

TEST(CellNeighbours, AreThoseInThePictureAndTheCellItself) {
  const Cells cells(MakeCamera(640, 480, false));
  const auto count = [&](int cell, int reach) {
    int found = 0;
    cells.VisitAround(cell, reach, [&](int) { ++found; });
    return found;
  };
  EXPECT_EQ(count(0, 1), 4);
  EXPECT_EQ(count(5, 1), 6);
  EXPECT_EQ(count(5 * cells.columns() + 5, 1), 9);
  EXPECT_EQ(count(5 * cells.columns() + 5, 2), 25);
  EXPECT_EQ(count(cells.count() - 1, 1), 4);
  EXPECT_EQ(count(7, 0), 1);
}

TEST(ApartInDepth, AreCellsWithAStepBetweenThem) {
  const std::vector<float> depth = {2, 2.1f, 2.2f, 1.9f, 1.8f, 0};
  const std::vector<bool> apart = {false, false, true, false, true, false};
  for (int other = 0; other < 6; ++other) {
    EXPECT_EQ(ApartInDepth(depth, 0, other), apart[other]) << other;
    EXPECT_FALSE(ApartInDepth(depth, 5, other)) << other;
    EXPECT_FALSE(ApartInDepth({}, 0, other)) << other;
  }
}

// The same reading everywhere.
TEST(DepthOfCells, IsTheSameFromBothKindsOfImagesInMetres) {
  const Camera camera = MakeCamera(401, 303, false);
  const Cells cells(camera);
  const cv::Mat metres(camera.height, camera.width, CV_32F, cv::Scalar(2.5));
  const cv::Mat units(camera.height, camera.width, CV_16U, cv::Scalar(2.5 * camera.depth_factor));
  for (const cv::Mat& image : {metres, units}) {
    for (float z : DepthOfCells(cells, camera, image)) ASSERT_NEAR(z, 2.5f, 1e-5f);
  }
}

TEST(DepthOfCells, IsNotMovedByAFewWrongReadings) {
  const Camera camera = MakeCamera(640, 480, false);
  const Cells cells(camera);
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(2));
  // Every third column, as the nine readings of a cell are in three columns.
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = y % 2; x < depth.cols; x += 8) depth.at<float>(y, x) = 9;
  }
  for (float z : DepthOfCells(cells, camera, depth)) ASSERT_EQ(z, 2);
}

TEST(DepthOfCells, IsUnknownInHolesAndKnownBesideThem) {
  const Camera camera = MakeCamera(640, 480, false);
  const Cells cells(camera);
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(2));
  depth(cv::Rect(160, 160, 80, 80)) = 0;
  depth(cv::Rect(320, 160, 80, 80)) = std::nanf("");
  depth(cv::Rect(480, 160, 80, 80)) = -1;
  const std::vector<float> cell_depth = DepthOfCells(cells, camera, depth);
  for (int i = 0; i < cells.count(); ++i) {
    const cv::Point2f p = cells.Centre(i);
    const bool row = p.y > 160 && p.y < 240;
    const bool hole =
        row && ((p.x > 160 && p.x < 240) || (p.x > 320 && p.x < 400) || (p.x > 480 && p.x < 560));
    ASSERT_EQ(cell_depth[i], hole ? 0 : 2) << p.x << " " << p.y;
  }
}

TEST(DepthOfCells, FollowsTheStepBetweenTwoSurfaces) {
  const Camera camera = MakeCamera(640, 480, false);
  const Cells cells(camera);
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(4));
  depth(cv::Rect(0, 0, 320, 480)) = 1.5f;
  const std::vector<float> cell_depth = DepthOfCells(cells, camera, depth);
  for (int i = 0; i < cells.count(); ++i)
    ASSERT_EQ(cell_depth[i], cells.Centre(i).x < 320 ? 1.5f : 4.0f);
}

TEST(StereoDepthOfCells, IsThatOfTheRenderedRoom) {
  SynthSettings settings;
  settings.frames = 600;
  settings.stereo = true;
  settings.actors = 1;
  const SynthRecording recording(settings);
  const Camera& camera = recording.camera();
  const Cells cells(camera);
  for (int number : {0, 200, 400}) {
    const RenderedFrame frame = recording.Render(number);
    const std::vector<float> found = StereoDepthOfCells(cells, camera, frame.image, frame.right);
    const std::vector<float> truth = DepthOfCells(cells, camera, frame.depth_exact);
    std::vector<double> errors;
    int wrong = 0;
    for (int i = 0; i < cells.count(); ++i) {
      if (!(found[i] > 0) || !(truth[i] > 0)) continue;
      errors.push_back(std::abs(found[i] / truth[i] - 1));
      wrong += errors.back() > 0.25;
    }
    // Half of the room's image has texture for matching.
    ASSERT_GT(errors.size(), cells.count() * 0.4) << number;
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    // At 3 m the disparity is 19 pixels of the full-size image; half a pixel is 2.6 % of it.
    EXPECT_LT(errors[errors.size() / 2], 0.03) << number;
    EXPECT_LT(wrong, 0.08 * static_cast<double>(errors.size())) << number;
  }
}

TEST(StereoDepthOfCells, IsUnknownWhereThereIsNothingToMatch) {
  Camera camera = MakeCamera(640, 480, false);
  camera.depth_factor = 0;
  camera.baseline = 0.11;
  const Cells cells(camera);
  const cv::Mat plain(480, 640, CV_8U, cv::Scalar(128));
  for (float z : StereoDepthOfCells(cells, camera, plain, plain)) ASSERT_EQ(z, 0);
}

}  // namespace
}  // namespace alidade::cells_test
