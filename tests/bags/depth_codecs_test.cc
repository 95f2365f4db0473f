// Depth packed by image_transport's compressedDepth: PNG and RVL, millimeters and inverse depth.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "alidade/io/files/open_source.h"
#include "alidade/io/ros/messages/rvl.h"
#include "bags/rvl_bytes.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::depth_codecs_test {
namespace {

using testing::HasSubstr;

// Runs of holes and of values, rising, falling and jumping.
cv::Mat Landscape(int seed) {
  cv::Mat depth(kTinyHeight, kTinyWidth, CV_16UC1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const bool hole = (x / 7 + y / 5 + seed) % 4 == 0;
      const int value = 1000 + 37 * y - 11 * x + (x % 13 == 0 ? 40000 : 0);
      depth.at<uint16_t>(y, x) = hole ? uint16_t{0} : static_cast<uint16_t>(value);
    }
  }
  return depth;
}

struct Quantization {
  float a = 0, b = 0;
};

std::string Head(Quantization q) {
  std::string head(4, '\0');
  return head.append(reinterpret_cast<const char*>(&q), sizeof q);
}

class DepthCodecs : public testing::Test {
 protected:
  // The depth of the first frame of a recording with this message.
  SourceFrame Frame(const std::string& format, const std::string& data, bool ros1 = false) {
    const Dialect dialect{!ros1};
    const std::vector<WrittenMessage> messages = {
        {"/camera/rgb/image_raw", "sensor_msgs/Image", kStart,
         ImageMessage(dialect, kStart, "camera", "mono8", TinyImage(1))},
        {"/camera/rgb/camera_info", "sensor_msgs/CameraInfo", kStart,
         InfoMessage(dialect, kStart, {})},
        {"/camera/depth/image_raw/compressedDepth", "sensor_msgs/CompressedImage", kStart,
         CompressedMessage(dialect, kStart, "camera", format, data)}};
    const std::string path =
        ros1 ? folder_.Write("walk.bag", BagBytes({"none"}).Of(messages))
             : folder_.Write("walk.mcap", McapBytes({"zstd"}, false).Of(messages));
    const auto source = OpenSource(path, {.sensor = Sensor::kRgbd});
    std::optional<SourceFrame> frame = source->Next();
    if (!frame) ThrowInput("no frame");
    return *frame;
  }
  TempFolder folder_;
};

// Runs and differences by hand: 2 zeros, 2 others, +5 (stored 10: 2 with more to come, 1), -1.
TEST(Rvl, HasTheFormOfThePaper) {
  using namespace std::string_literals;
  const cv::Mat depth = DecodeRvl("\4\0\0\0\1\0\0\0\x00\x10\xa1\x22"s);
  ASSERT_EQ(depth.size(), cv::Size(4, 1));
  const std::vector<uint16_t> pixels(depth.begin<uint16_t>(), depth.end<uint16_t>());
  EXPECT_THAT(pixels, testing::ElementsAre(0, 0, 5, 4));
}

TEST_F(DepthCodecs, WithoutLossReturnTheSamePixels) {
  for (int i = 0; i < 4; ++i) {
    const cv::Mat depth = Landscape(i);
    const std::string png = Head({}) + EncodePng(depth), rvl = Head({}) + RvlBytes(depth);
    for (const bool ros1 : {false, true}) {
      const auto check = [&](const std::string& format, const std::string& data) {
        const SourceFrame frame = Frame(format, data, ros1);
        ASSERT_EQ(frame.depth.type(), CV_16UC1) << format << frame.incomplete;
        EXPECT_EQ(cv::norm(frame.depth, depth, cv::NORM_INF), 0) << format;
      };
      check("16UC1; compressedDepth rvl", rvl);
      check("16UC1; compressedDepth png", png);
      check("16UC1; compressedDepth", png);
      check("16UC1; compressedDepth", rvl);
      check("16UC1; compressedDepth ", png);
      check("16UC1; compressedDepth png", EncodePng(depth));  // without a head
    }
  }
}

// v = a / z + b with the parameters that image_transport chooses for depth up to 10 m:
// a = q (q + 1), b = 1 - a / 10, q = 100.
TEST_F(DepthCodecs, OfMetresAreInverseDepth) {
  const float a = 100 * 101, b = 1 - a / 10;
  cv::Mat stored(kTinyHeight, kTinyWidth, CV_16UC1, cv::Scalar(0)), metres(stored.size(), CV_32FC1);
  for (int y = 0; y < stored.rows; ++y) {
    for (int x = 0; x < stored.cols; ++x) {
      const float z = x == 3 ? 0 : 0.3f + 0.1f * static_cast<float>(y + x) / 2;
      stored.at<uint16_t>(y, x) = z > 0 ? static_cast<uint16_t>(a / z + b) : uint16_t{0};
      metres.at<float>(y, x) = z;
    }
  }
  for (const bool rvl : {false, true}) {
    const SourceFrame frame = Frame(std::string("32FC1; compressedDepth ") + (rvl ? "rvl" : "png"),
                                    Head({a, b}) + (rvl ? RvlBytes(stored) : EncodePng(stored)));
    ASSERT_EQ(frame.depth.type(), CV_32FC1) << frame.incomplete;
    for (int y = 0; y < stored.rows; ++y) {
      for (int x = 0; x < stored.cols; ++x) {
        const float z = frame.depth.at<float>(y, x), v = stored.at<uint16_t>(y, x);
        EXPECT_EQ(z, v == 0 ? 0 : a / (v - b));
        // A step of v is z^2 / a meters.
        EXPECT_NEAR(z, metres.at<float>(y, x), 1.01 * z * z / a);
      }
    }
  }
}

TEST_F(DepthCodecs, ThatAreDamagedAreTold) {
  const cv::Mat depth = Landscape(0);
  const std::string rvl = Head({}) + RvlBytes(depth);
  const auto told = [&](const std::string& format, const std::string& data) {
    const SourceFrame frame = Frame(format, data);
    EXPECT_TRUE(frame.depth.empty());
    EXPECT_FALSE(frame.image.empty());  // it is still a frame of one camera
    return frame.incomplete;
  };
  EXPECT_THAT(told("16UC1; compressedDepth rvl", rvl.substr(0, rvl.size() / 2)),
              HasSubstr("RVL data ends early"));
  EXPECT_THAT(told("32FC1; compressedDepth rvl", rvl), HasSubstr("quantization"));
  EXPECT_THAT(told("16UC1; compressedDepth png", Head({}) + EncodePng(depth).substr(0, 400)),
              HasSubstr("PNG"));
  EXPECT_THAT(
      told("16UC1; compressedDepth rvl", rvl.substr(0, 20) + std::string(rvl.size() - 20, '\xff')),
      HasSubstr("RVL data"));
  const std::string refused =
      MessageOf(ErrorKind::kUsage, [&] { Frame("16UC1; compressedDepth zstd", rvl); });
  EXPECT_THAT(refused, HasSubstr("has no depth"));
}

// Every cut and every changed byte ends in an image or in an error.
TEST(Rvl, OfHostileBytesIsAnErrorOrAnImage) {
  const std::string good = RvlBytes(Landscape(1));
  for (size_t i = 0; i < good.size(); ++i) {
    EXPECT_THROW(DecodeRvl(std::string_view(good).substr(0, i)), Error);
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x88);
    try {
      EXPECT_FALSE(DecodeRvl(bad).empty());
    } catch (const Error& error) {
      EXPECT_STRNE(error.what(), "");
    }
  }
}

}  // namespace
}  // namespace alidade::depth_codecs_test
