// Recordings written by public libraries (tests/bags/make_samples): rosbag, and npm's @mcap/core
// with Foxglove's CDR.
#include <gmock/gmock.h>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"

namespace alidade::samples_test {
namespace {

std::string Sample(const std::string& name) {
  return std::string(ALIDADE_BAG_SAMPLES) + "/" + name;
}

// ROS 1 messages compressed by rosbag with lz4 and ROS 2 messages compressed with zstd: the same
// image.
TEST(Samples, OfPublicWritersAreOneRecording) {
  const auto bag = OpenSource(Sample("desk-lz4.bag")), mcap = OpenSource(Sample("desk-zstd.mcap"));
  for (const auto* source : {&bag, &mcap}) {
    const SourceInfo& info = (*source)->Info();
    EXPECT_EQ(info.sensor, Sensor::kRgbd);
    EXPECT_EQ(info.frames, 1);
    EXPECT_EQ(info.camera.width, 64);
    EXPECT_FALSE(info.camera_guessed);
  }
  EXPECT_EQ(bag->Info().camera.fx, mcap->Info().camera.fx);
  const auto a = bag->Next(), b = mcap->Next();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->problem, "");
  EXPECT_EQ(a->stamp, b->stamp);
  EXPECT_EQ(cv::norm(a->image, b->image, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a->depth, b->depth, cv::NORM_INF), 0);
  double least = 0, most = 0;
  cv::minMaxLoc(a->image, &least, &most);
  EXPECT_GT(most - least, 50);  // the image has contrast
  cv::minMaxLoc(a->depth, &least, &most);
  EXPECT_GT(most, 300);  // millimeters
  EXPECT_LT(most, 20000);
}

}  // namespace
}  // namespace alidade::samples_test
