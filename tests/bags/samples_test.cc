// Recordings by public writers (tests/bags/make_samples): rosbag itself, and npm's @mcap/core with
// Foxglove's CDR.
#include <gmock/gmock.h>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"

namespace alidade::samples_test {
namespace {

std::string Sample(const std::string& name) {
  return std::string(ALIDADE_BAG_SAMPLES) + "/" + name;
}

// ROS 1 messages packed by rosbag's lz4, ROS 2 messages packed by Zstandard: the same picture.
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
  EXPECT_GT(most - least, 50);  // a picture, not a surface
  cv::minMaxLoc(a->depth, &least, &most);
  EXPECT_GT(most, 300);  // millimetres
  EXPECT_LT(most, 20000);
}

}  // namespace
}  // namespace alidade::samples_test
