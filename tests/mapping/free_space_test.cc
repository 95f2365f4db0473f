// A wall 4 m before a depth camera that stands still, and a box 1.2 m away that comes into view.
#include "alidade/mapping/free_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "alidade/features/extractor.h"
#include "alidade/mapping/mapper.h"
#include "support/vga_camera.h"

namespace alidade::free_space_test {
namespace {

const cv::Rect kBox(160, 120, 240, 240);  // pixels

class FreeSpaceTest : public testing::Test {
 protected:
  static Camera MakeCamera() {
    Camera camera = MakeVgaCamera();
    camera.depth_factor = 1000;
    return camera;
  }
  // Keypoints on a grid of 20 pixels. `box`: it is in view. Every third reading is missing, as far
  // away with real cameras.
  std::shared_ptr<const Frame> FrameAt(double time, bool box) {
    cv::Mat depth(480, 640, CV_16U, cv::Scalar(4000));
    if (box) depth(kBox).setTo(1200);
    for (int y = 0; y < 480; ++y)
      for (int x = y % 3; x < 640; x += 3) depth.at<uint16_t>(y, x) = 0;
    auto frame = std::make_shared<Frame>();
    frame->time = time;
    frame->number = static_cast<int>(30 * time);
    frame->image = cv::Mat(480, 640, CV_8U, cv::Scalar(0));
    for (int y = 31; y < 460; y += 20) {
      for (int x = y % 3 + 31; x < 620; x += 21) {  // where there is a reading
        Keypoint keypoint;
        keypoint.x = keypoint.raw_x = static_cast<float>(x + 1);
        keypoint.y = keypoint.raw_y = static_cast<float>(y);
        frame->keypoints.push_back(keypoint);
      }
    }
    frame->descriptors.resize(frame->keypoints.size());
    AttachDepth(depth, camera_, *frame, 8);
    frame->grid = KeypointGrid(frame->keypoints, 640, 480);
    frame->image.release();
    return frame;
  }
  KeyFrameId Insert(double time, bool box, double to_the_right = 0) {
    const Se3 T_camera_world{Eigen::Matrix3d::Identity(), {-to_the_right, 0, 0}};
    const KeyFrameId id = mapper_.Insert(
        FrameAt(time, box), AnchorTo(store_.Snapshot().state(), parent_, T_camera_world), {});
    parent_ = id;
    return id;
  }
  static bool OnBox(const Keypoint& keypoint) {
    return kBox.contains(cv::Point(static_cast<int>(keypoint.x), static_cast<int>(keypoint.y)));
  }
  // Landmarks of a keyframe on the box, and on the wall.
  std::pair<int, int> Landmarks(KeyFrameId id) {
    const MapSnapshot map = store_.Snapshot();
    const KeyFrame& keyframe = *map.Find(id);
    std::pair<int, int> count{0, 0};
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.landmarks[i].valid()) continue;
      ++(OnBox(keyframe.frame->keypoints[i]) ? count.first : count.second);
    }
    return count;
  }

  Camera camera_ = MakeCamera();
  MapStore store_;
  Mapper mapper_{store_, camera_, {}};
  KeyFrameId parent_;
};

TEST_F(FreeSpaceTest, WhatComesIntoViewDoesNotEnterTheMap) {
  const auto [before, wall] = Landmarks(Insert(0, false));
  EXPECT_GT(before, 50);  // the wall behind
  const auto [box, rest] = Landmarks(Insert(0.5, true));
  EXPECT_EQ(box, 0);
  EXPECT_GT(rest, wall / 2);
}

TEST_F(FreeSpaceTest, WhatIsThereFromTheStartEntersTheMap) {
  const auto [box, wall] = Landmarks(Insert(0, true));
  EXPECT_GT(box, 50);
  EXPECT_GT(wall, 200);
  EXPECT_GT(Landmarks(Insert(0.5, true)).first, 50);
}

TEST_F(FreeSpaceTest, WhatIsRevealedEntersTheMap) {
  Insert(0, true);
  EXPECT_GT(Landmarks(Insert(0.5, false)).first, 50) << "the wall behind the box";
}

TEST_F(FreeSpaceTest, WhatHasStoodForSecondsEntersTheMap) {
  Insert(0, false);
  for (double time : {0.5, 1.5, 2.5, 3.4}) EXPECT_EQ(Landmarks(Insert(time, true)).first, 0);
  EXPECT_GT(Landmarks(Insert(4.5, true)).first, 50);
}

TEST_F(FreeSpaceTest, WhatANewViewShowsEntersTheMap) {
  Insert(0, false);
  // 3 m to the right the box is outside of what the first keyframe saw.
  EXPECT_GT(Landmarks(Insert(0.5, true, 3)).first, 50);
}

}  // namespace
}  // namespace alidade::free_space_test
