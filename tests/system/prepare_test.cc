#include "alidade/system/prepare.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

#include "alidade/slam.h"
#include "support/expect_error.h"

namespace alidade::prepare_test {
namespace {

cv::Size SizeInUse(int width, int height, const SlamSettings& settings = {}) {
  const Camera used = CameraInUse(Camera::FromFieldOfView(width, height, 60), settings);
  return {used.width, used.height};
}

TEST(CameraInUse, ScalesDownWhatIsLargerThanHelps) {
  EXPECT_EQ(SizeInUse(3840, 2160), cv::Size(1920, 1080));
  EXPECT_EQ(SizeInUse(2160, 3840), cv::Size(1080, 1920));  // a phone held upright
  EXPECT_EQ(SizeInUse(4000, 3000), cv::Size(1920, 1440));
  EXPECT_EQ(SizeInUse(1920, 1080), cv::Size(1920, 1080));
  EXPECT_EQ(SizeInUse(640, 480), cv::Size(640, 480));
}

TEST(CameraInUse, TakesTheWidthThatIsAskedFor) {
  SlamSettings settings;
  settings.image_width = 400;
  EXPECT_EQ(SizeInUse(3840, 2160, settings), cv::Size(400, 225));
  settings.image_width = 3840;
  EXPECT_EQ(SizeInUse(3840, 2160, settings), cv::Size(3840, 2160));
  settings.image_width = settings.max_image_side = 0;
  EXPECT_EQ(SizeInUse(3840, 2160, settings), cv::Size(3840, 2160));
}

TEST(CameraInUse, SeesTheSamePlacesInTheSmallerPicture) {
  const Camera given = Camera::FromFieldOfView(3840, 2160, 60);
  const Camera used = CameraInUse(given, {});
  const Eigen::Vector3d p(0.3, -0.2, 1);
  const Eigen::Vector2d large = given.Project(p), small = used.Project(p);
  EXPECT_NEAR(small.x(), (large.x() + 0.5) / 2 - 0.5, 1e-9);
  EXPECT_NEAR(small.y(), (large.y() + 0.5) / 2 - 0.5, 1e-9);
}

TEST(Prepare, ScalesThePicture) {
  const Camera given = Camera::FromFieldOfView(3840, 2160, 60);
  const SlamSettings settings;
  FrameInput input;
  input.image = cv::Mat(2160, 3840, CV_8UC1, cv::Scalar(90));
  const FrameInput prepared = Prepare(input, given, CameraInUse(given, settings), settings);
  EXPECT_EQ(prepared.image.size(), cv::Size(1920, 1080));
  EXPECT_EQ(cv::mean(prepared.image)[0], 90);
}

TEST(Prepare, AnImageOfAnotherNumberOfChannelsIsRefusedAndNotCounted) {
  const Camera camera = Camera::FromFieldOfView(320, 240, 60);
  SlamSettings stereo;
  stereo.sensor = Sensor::kStereo;
  Camera pair = camera;
  pair.baseline = 0.1;
  const cv::Mat gray(240, 320, CV_8UC1, cv::Scalar(90));
  for (int channels : {2, 5}) {
    const cv::Mat image(240, 320, CV_8UC(channels));
    Slam one(camera, {}), two(pair, stereo);
    EXPECT_THAT(MessageOf(ErrorKind::kInput,
                          [&] {
                            one.Track({0, image, {}, {}});
                          }),
                testing::HasSubstr("not " + std::to_string(channels)));
    EXPECT_THAT(MessageOf(ErrorKind::kInput,
                          [&] {
                            two.Track({0, gray, image, {}});
                          }),
                testing::HasSubstr("channels"));
    EXPECT_EQ(one.frames() + two.frames(), 0);
    one.Track({0, gray, {}, {}});  // so its time is free
    EXPECT_EQ(one.frames(), 1);
  }
}

TEST(Prepare, AColorImageOfAnotherNumberOfChannelsIsRefused) {
  const Camera camera = Camera::FromFieldOfView(320, 240, 60);
  SlamSettings settings;
  settings.dynamics.mode = DynamicsMode::kFull;
  ASSERT_TRUE(settings.WantsColor());
  FrameInput input;
  input.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(90));
  input.color = cv::Mat(240, 320, CV_8UC(5));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { Prepare(input, camera, camera, settings); }),
              testing::HasSubstr("three or four"));
}

}  // namespace
}  // namespace alidade::prepare_test
