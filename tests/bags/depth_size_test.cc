// Depth of a whole fraction of the images' size, in recordings of ROS and in folders.
#include "alidade/io/files/depth_size.h"

#include <gmock/gmock.h>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::depth_size_test {
namespace {

using testing::HasSubstr;
using testing::Not;

// Every pixel has its own value; one in five has none.
cv::Mat Numbered(cv::Size size, int type) {
  cv::Mat depth(size, CV_32FC1);
  for (int i = 0; i < static_cast<int>(depth.total()); ++i)
    depth.at<float>(i / size.width, i % size.width) = i % 5 == 0 ? 0 : static_cast<float>(1000 + i);
  depth.convertTo(depth, type);
  return depth;
}

void ExpectBlocks(const cv::Mat& scaled, const cv::Mat& depth, int times) {
  ASSERT_EQ(scaled.size(), depth.size() * times);
  ASSERT_EQ(scaled.type(), depth.type());
  cv::Mat a, b;
  scaled.convertTo(a, CV_32F);
  depth.convertTo(b, CV_32F);
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x)
      ASSERT_EQ(a.at<float>(y, x), b.at<float>(y / times, x / times)) << x << " " << y;
  }
}

TEST(DepthSize, OfAnyWholeFractionBecomesBlocks) {
  for (int times = 2; times < 60; ++times) {
    for (const int type : {CV_16UC1, CV_32FC1}) {
      const cv::Mat depth = Numbered({7, 5}, type);
      ExpectBlocks(ScaledUpDepth(depth, depth.size() * times), depth, times);
    }
  }
  const cv::Mat depth = Numbered({8, 6}, CV_16UC1);
  for (const cv::Size size : {cv::Size(8, 6), {16, 6}, {12, 9}, {4, 3}, {17, 12}})
    EXPECT_EQ(ScaledUpDepth(depth, size).size(), depth.size());
}

class DepthSizeInBags : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> Open(const cv::Mat& depth, const std::string& query = "",
                                    const std::string& encoding = "16UC1") {
    const Dialect ros1{false};
    const std::string path = folder_.Write(
        "walk.bag",
        BagBytes({"none"}).Of(
            {{"/rgb/image_raw", "sensor_msgs/Image", kStart,
              ImageMessage(ros1, kStart, "camera", "mono8", TinyImage(1))},
             {"/rgb/camera_info", "sensor_msgs/CameraInfo", kStart, InfoMessage(ros1, kStart, {})},
             {"/depth/image_raw", "sensor_msgs/Image", kStart,
              ImageMessage(ros1, kStart, "camera", encoding, depth)}}));
    return OpenSource(path + query);
  }
  TempFolder folder_;
};

TEST_F(DepthSizeInBags, IsScaledUpAndToldOnce) {
  for (const int times : {1, 2, 4, 8, 16}) {
    const cv::Mat depth = Numbered({kTinyWidth / times, kTinyHeight / times}, CV_16UC1);
    const auto source = Open(depth);
    EXPECT_EQ(source->Info().sensor, Sensor::kRgbd);
    const auto told =
        HasSubstr("Depth images of " + SizeText(depth.size()) + " are scaled up to 64x48");
    if (times == 1) {
      EXPECT_THAT(source->Info().told, Not(HasSubstr("scaled")));
    } else {
      EXPECT_THAT(source->Info().told, told);
    }
    const auto frame = source->Next();
    EXPECT_EQ(frame->incomplete, "");
    ExpectBlocks(frame->depth, depth, times);
  }
  const cv::Mat metres = Numbered({32, 24}, CV_32FC1);
  ExpectBlocks(Open(metres, "", "32FC1")->Next()->depth, metres, 2);
}

TEST_F(DepthSizeInBags, OfNoWholeFractionIsRefused) {
  const cv::Mat depth = Numbered({40, 30}, CV_16UC1);
  EXPECT_EQ(Open(depth)->Info().sensor, Sensor::kMono);
  const std::string refused =
      MessageOf(ErrorKind::kUsage, [&] { Open(depth, "?depth=/depth/image_raw"); });
  EXPECT_THAT(refused, HasSubstr("depth=/depth/image_raw has 40x30, but /rgb/image_raw has 64x48"));
  EXPECT_THAT(refused, HasSubstr("a half, a third"));
}

TEST(DepthSizeInFolders, IsScaledUpOrRefused) {
  const TempFolder folder;
  WriteTinyTum(folder, {.frames = 2});
  const auto write = [&](cv::Size size) {
    const cv::Mat depth = Numbered(size, CV_16UC1);
    for (int i = 0; i < 2; ++i) WriteImage(folder / ("depth/" + TinyStamp(i) + ".png"), depth);
    return depth;
  };
  for (const int times : {2, 4}) {
    const cv::Mat depth = write(cv::Size(64, 48) / times);
    const auto source = OpenSource(folder.path());
    EXPECT_THAT(source->Info().told, HasSubstr("are scaled up to 64x48"));
    ExpectBlocks(source->Next()->depth, depth, times);
  }
  write({40, 30});
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); }),
              HasSubstr("depth images of 40x30 do not fit images of 64x48"));
  EXPECT_EQ(OpenSource(folder.path(), {.sensor = Sensor::kMono})->Info().sensor, Sensor::kMono);
  // One bad image among good ones loses its frame's depth alone.
  write({32, 24});
  WriteImage(folder / ("depth/" + TinyStamp(0) + ".png"), Numbered({40, 30}, CV_16UC1));
  const auto source = OpenSource(folder.path());
  EXPECT_THAT(source->Next()->incomplete, HasSubstr("40x30, but the recording has 64x48"));
  EXPECT_FALSE(source->Next()->depth.empty());
}

}  // namespace
}  // namespace alidade::depth_size_test
