// Alignment of rendered images, whose poses and depths are known.
#include "alidade/tracking/frame_alignment.h"

#include <gtest/gtest.h>

#include "alidade/features/extractor.h"
#include "alidade/synth/recording.h"

namespace alidade::frame_alignment_test {
namespace {

struct Scene {
  explicit Scene(SynthSettings settings) : recording(std::move(settings)) {}
  SynthRecording recording;

  Se3 Pose(int number) const { return recording.Pose(number).Inverse(); }  // T_camera_world
  // Points of image `number` at its keypoints, from exact depth.
  std::vector<ReferencePoint> Points(const RenderedFrame& rendered, int number) const {
    const Camera& camera = recording.camera();
    const Frame frame = Extractor().Extract(rendered.image, camera, rendered.time, number);
    std::vector<ReferencePoint> points;
    for (size_t k = 0; k < frame.keypoints.size(); ++k) {
      const Keypoint& keypoint = frame.keypoints[k];
      const float z = rendered.depth_exact.at<float>(static_cast<int>(std::lround(keypoint.raw_y)),
                                                     static_cast<int>(std::lround(keypoint.raw_x)));
      if (!(z > 0)) continue;
      points.push_back({recording.Pose(number) * camera.Unproject(keypoint.pixel(), z),
                        {keypoint.raw_x, keypoint.raw_y},
                        keypoint.level,
                        static_cast<int>(k)});
    }
    return points;
  }
};

SynthSettings Room(uint64_t seed) {
  SynthSettings settings;
  settings.seed = seed;
  return settings;
}

double Metres(const Se3& a, const Se3& b) { return (a.Inverse().t - b.Inverse().t).norm(); }

// Aligns image `now` with `before`, beginning at the pose of `before`: no motion is known.
void ExpectAligned(const Scene& scene, int before, int now, double least_found) {
  const RenderedFrame reference = scene.recording.Render(before);
  const RenderedFrame image = scene.recording.Render(now);
  const std::vector<ReferencePoint> points = scene.Points(reference, before);
  ASSERT_GT(points.size(), 300u);
  FrameAlignment alignment;
  EXPECT_FALSE(alignment.has_reference());
  alignment.SetReference(reference.image, 5000);
  Se3 pose = scene.Pose(before);
  const std::vector<AlignedPoint> aligned =
      alignment.Align(scene.recording.camera(), image.image, points, scene.Pose(before), pose);
  ASSERT_EQ(aligned.size(), points.size());
  EXPECT_LT(Metres(pose, scene.Pose(now)), 0.01);
  EXPECT_LT(RotationAngle(pose, scene.Pose(now)), 0.003);

  const Camera& camera = scene.recording.camera();
  int expected = 0, found = 0, near = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    expected += aligned[i].expected;
    found += aligned[i].found;
    const Eigen::Vector3d p = scene.Pose(now) * points[i].p_world;
    if (!aligned[i].found || p.z() < 0.1) continue;
    EXPECT_TRUE(aligned[i].expected);
    const Eigen::Vector2d truth = camera.Distort(camera.Project(p));
    near += (aligned[i].raw.cast<double>() - truth).norm() < 0.5 * ScaleOfLevel(points[i].level);
  }
  EXPECT_GT(found, least_found * expected);
  EXPECT_GT(near, 0.85 * found);  // the others are on edges of objects, or hidden
}

TEST(FrameAlignment, FindsPoseAndPointsWithoutKnowingTheMotion) {
  for (const uint64_t seed : {4, 5}) {
    SCOPED_TRACE(seed);
    ExpectAligned(Scene(Room(seed)), 20, 22, 0.8);
  }
}

TEST(FrameAlignment, AllowsForTheLensAndTheExposure) {
  SynthSettings settings = Room(6);
  settings.distortion = true;
  settings.exposure = true;
  ExpectAligned(Scene(settings), 40, 42, 0.75);
}

TEST(FrameAlignment, FindsLittleInAnotherPlace) {
  const Scene scene(Room(7));
  const RenderedFrame reference = scene.recording.Render(0), other = scene.recording.Render(300);
  const std::vector<ReferencePoint> points = scene.Points(reference, 0);
  FrameAlignment alignment;
  alignment.SetReference(reference.image, 5000);
  Se3 pose = scene.Pose(0);
  int expected = 0, found = 0;
  for (const AlignedPoint& point :
       alignment.Align(scene.recording.camera(), other.image, points, scene.Pose(0), pose)) {
    expected += point.expected;
    found += point.found;
  }
  EXPECT_LT(found, 0.3 * expected);
}

TEST(FrameAlignment, SurvivesImagesThatShowNothing) {
  const Scene scene(Room(8));
  const RenderedFrame reference = scene.recording.Render(0);
  const std::vector<ReferencePoint> points = scene.Points(reference, 0);
  FrameAlignment alignment;
  alignment.SetReference(reference.image, 5000);
  for (const int gray : {0, 128, 255}) {
    Se3 pose = scene.Pose(0);
    const cv::Mat blank(reference.image.size(), CV_8U, cv::Scalar(gray));
    for (const AlignedPoint& point :
         alignment.Align(scene.recording.camera(), blank, points, scene.Pose(0), pose))
      EXPECT_FALSE(point.found);
    EXPECT_TRUE(pose.t.allFinite() && pose.R.allFinite());
  }
  Se3 pose = scene.Pose(0);
  EXPECT_TRUE(
      alignment.Align(scene.recording.camera(), reference.image, {}, scene.Pose(0), pose).empty());
}

}  // namespace
}  // namespace alidade::frame_alignment_test
