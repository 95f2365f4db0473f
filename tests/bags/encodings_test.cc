// Encodings of 16 bits and of luma and chroma, as frames of a recording, compared with formulas.
#include <gmock/gmock.h>

#include <cmath>

#include "alidade/io/files/open_source.h"
#include "alidade/io/ros/messages/picture_of_message.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::encodings_test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 66, kHeight = 50;

// Uses all levels, so that 16 bits become 8 by a division by 257.
cv::Mat Colors16() {
  cv::Mat image(kHeight, kWidth, CV_16UC3);
  Random random(5);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      for (int channel = 0; channel < 3; ++channel)
        image.at<cv::Vec3w>(y, x)[channel] = static_cast<uint16_t>(random.Below(65536));
    }
  }
  return image;
}

std::string Rows16(const std::vector<uint16_t>& values, bool big_endian) {
  std::string rows;
  for (const uint16_t value : values) {
    const char low = static_cast<char>(value & 255), high = static_cast<char>(value >> 8);
    rows += big_endian ? std::string{high, low} : std::string{low, high};
  }
  return rows;
}

std::string Message(Dialect dialect, const std::string& encoding, cv::Size size, uint32_t step,
                    bool big_endian, const std::string& rows) {
  return MessageBytes(dialect.cdr, dialect.big_endian)
      .Header(kStart, "camera")
      .U32(static_cast<uint32_t>(size.height))
      .U32(static_cast<uint32_t>(size.width))
      .Text(encoding)
      .U8(big_endian)
      .U32(step)
      .Bytes(rows)
      .Done();
}

class Encodings : public testing::TestWithParam<bool> {
 protected:
  // The first frame of a recording of ROS 1 or ROS 2 with such an image.
  SourceFrame Frame(const std::string& encoding, cv::Size size, uint32_t step, bool big_endian,
                    const std::string& rows) {
    const bool ros1 = GetParam();
    const Dialect dialect{!ros1};
    const std::vector<WrittenMessage> messages = {
        {"/camera/image_raw", "sensor_msgs/Image", kStart,
         Message(dialect, encoding, size, step, big_endian, rows)}};
    std::string path = folder_ / "walk.db3";
    std::filesystem::remove(path);
    if (ros1) {
      path = folder_.Write("walk.bag", BagBytes({"lz4"}).Of(messages));
    } else {
      WriteDatabase(path, messages);
    }
    const auto source = OpenSource(path, {.fov_degrees = 60, .color = true});
    std::optional<SourceFrame> frame = source->Next();
    if (!frame) ThrowInput("no frame");
    EXPECT_EQ(frame->problem, "") << encoding;
    return *frame;
  }
  TempFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(OfRos, Encodings, testing::Bool(), [](const auto& test) {
  return test.param ? std::string("Ros1") : std::string("Ros2");
});

double Luma(const cv::Vec3d& color) {
  return 0.114 * color[0] + 0.587 * color[1] + 0.299 * color[2];
}

TEST_P(Encodings, OfThreeAndFourChannelsOf16BitsHaveTheirColors) {
  const cv::Mat color = Colors16();
  for (const std::string name : {"rgb16", "bgr16", "rgba16", "bgra16", "16UC3", "16UC4"}) {
    const bool rgb = name.rfind("rgb", 0) == 0, four = name.find('a') < 4 || name == "16UC4";
    for (const bool big_endian : {false, true}) {
      std::vector<uint16_t> values;
      for (const auto& pixel : cv::Mat_<cv::Vec3w>(color)) {
        for (const int channel : {0, 1, 2}) values.push_back(pixel[rgb ? 2 - channel : channel]);
        if (four) values.push_back(1234);
      }
      const SourceFrame frame =
          Frame(name, color.size(), static_cast<uint32_t>(kWidth * (four ? 8 : 6)), big_endian,
                Rows16(values, big_endian));
      ASSERT_EQ(frame.color.type(), CV_8UC3) << name;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const cv::Vec3w pixel = color.at<cv::Vec3w>(y, x);
          for (int channel = 0; channel < 3; ++channel)
            ASSERT_EQ(frame.color.at<cv::Vec3b>(y, x)[channel], std::lround(pixel[channel] / 257.0))
                << name;
          ASSERT_NEAR(frame.image.at<uchar>(y, x), Luma(pixel) / 257, 0.51) << name;
        }
      }
    }
  }
}

// Bilinear interpolation of a mosaic: the mean of the nearest samples of a color among the 3 x 3
// pixels around (x, y). `letters`: the colors of the top-left 2 x 2 pixels.
cv::Vec3d Interpolated(const cv::Mat& raw, const std::string& letters, int x, int y) {
  cv::Vec3d mean;
  for (int channel = 0; channel < 3; ++channel) {
    for (int distance = 0; distance <= 2; ++distance) {  // squared
      double sum = 0;
      int count = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const size_t cell = static_cast<size_t>(2 * ((y + dy) % 2) + (x + dx) % 2);
          if (dx * dx + dy * dy != distance || letters[cell] != "bgr"[channel]) continue;
          sum += raw.at<uint16_t>(y + dy, x + dx);
          ++count;
        }
      }
      if (count == 0) continue;
      mean[channel] = sum / count;
      break;
    }
  }
  return mean;
}

TEST_P(Encodings, OfBayerPatternsOf16BitsAreInterpolated) {
  cv::Mat raw(kHeight, kWidth, CV_16UC1);
  Random random(7);
  for (auto& pixel : cv::Mat_<uint16_t>(raw)) pixel = static_cast<uint16_t>(random.Below(65536));
  const std::vector<uint16_t> values(raw.begin<uint16_t>(), raw.end<uint16_t>());
  for (const std::string letters : {"rggb", "bggr", "gbrg", "grbg"}) {
    for (const bool big_endian : {false, true}) {
      const std::string rows = Rows16(values, big_endian);
      const std::string message =
          Message({false}, "bayer_" + letters + "16", raw.size(), 2 * kWidth, big_endian, rows);
      const DecodedImage decoded =
          PictureOf(ParseRosPicture(message, Serialization::kRos1, false), ImageUse::kGrayAndColor);
      const SourceFrame frame =
          Frame("bayer_" + letters + "16", raw.size(), 2 * kWidth, big_endian, rows);
      for (int y = 1; y + 1 < kHeight; ++y) {
        for (int x = 1; x + 1 < kWidth; ++x) {
          const cv::Vec3d color = Interpolated(raw, letters, x, y);
          for (int channel = 0; channel < 3; ++channel) {
            // Halves are rounded up.
            ASSERT_EQ(decoded.color.at<cv::Vec3w>(y, x)[channel], std::floor(color[channel] + 0.5))
                << letters;
          }
          ASSERT_NEAR(decoded.image.at<uint16_t>(y, x), Luma(color), 2) << letters;
          ASSERT_NEAR(frame.image.at<uchar>(y, x), Luma(color) / 257, 0.51) << letters;
        }
      }
    }
  }
}

// A sensor of 12 bits: gray and color are stretched by the same line.
TEST_P(Encodings, OfFewerBitsThan16AreStretchedInColorAsInGray) {
  std::vector<uint16_t> values;
  for (int i = 0; i < kWidth * kHeight; ++i)
    for (int channel = 0; channel < 3; ++channel)
      values.push_back(static_cast<uint16_t>(500 + 3000 * i / (kWidth * kHeight)));
  const SourceFrame frame =
      Frame("rgb16", {kWidth, kHeight}, 6 * kWidth, false, Rows16(values, false));
  double low = 0, high = 0;
  cv::minMaxLoc(frame.image, &low, &high);
  EXPECT_GT(high - low, 150);
  cv::Mat green;
  cv::extractChannel(frame.color, green, 1);
  EXPECT_LE(cv::norm(green, frame.image, cv::NORM_INF), 1);
}

struct Yuv {
  cv::Mat y, u, v;  // one value per pixel; u and v are shared by neighbors as the encoding needs
};

// `across`, `down`: pixels that share chroma.
Yuv RandomYuv(int across, int down) {
  Yuv yuv;
  Random random(11);
  for (cv::Mat* plane : {&yuv.y, &yuv.u, &yuv.v}) {
    *plane = cv::Mat(kHeight, kWidth, CV_8UC1);
    for (auto& value : cv::Mat_<uchar>(*plane)) value = static_cast<uchar>(random.Below(256));
    if (plane == &yuv.y) continue;
    const cv::Mat each = plane->clone();
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x)
        plane->at<uchar>(y, x) = each.at<uchar>(y / down * down, x / across * across);
    }
  }
  return yuv;
}

void ExpectYuv(const SourceFrame& frame, const Yuv& yuv, const std::string& name) {
  ASSERT_EQ(frame.color.type(), CV_8UC3) << name;
  EXPECT_EQ(cv::norm(frame.image, yuv.y, cv::NORM_INF), 0) << name;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // ITU-R BT.601: luma 16 to 235, chroma 16 to 240.
      const double luma = (yuv.y.at<uchar>(y, x) - 16) * 255 / 219.0;
      const double cb = (yuv.u.at<uchar>(y, x) - 128) / 224.0,
                   cr = (yuv.v.at<uchar>(y, x) - 128) / 224.0;
      const double blue = luma + 255 * 1.772 * cb, red = luma + 255 * 1.402 * cr;
      const double green = luma - 255 * (0.344136 * cb + 0.714136 * cr);
      const cv::Vec3b pixel = frame.color.at<cv::Vec3b>(y, x);
      // Luma below 16 is black in OpenCV, before chroma is added.
      const double tolerance = yuv.y.at<uchar>(y, x) < 16 ? 20 : 1;
      ASSERT_NEAR(pixel[0], std::clamp(blue, 0.0, 255.0), tolerance) << name;
      ASSERT_NEAR(pixel[1], std::clamp(green, 0.0, 255.0), tolerance) << name;
      ASSERT_NEAR(pixel[2], std::clamp(red, 0.0, 255.0), tolerance) << name;
    }
  }
}

TEST_P(Encodings, OfLumaAndChromaInTurnHaveTheirColors) {
  const Yuv yuv = RandomYuv(2, 1);
  std::string uyvy, yuyv;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const char luma = static_cast<char>(yuv.y.at<uchar>(y, x));
      const char chroma = static_cast<char>((x % 2 == 0 ? yuv.u : yuv.v).at<uchar>(y, x));
      uyvy += std::string{chroma, luma};
      yuyv += std::string{luma, chroma};
    }
  }
  for (const std::string name : {"yuv422", "uyvy", "yuv422_yuy2", "yuyv"}) {
    const bool luma_first = name == "yuv422_yuy2" || name == "yuyv";
    ExpectYuv(Frame(name, yuv.y.size(), 2 * kWidth, false, luma_first ? yuyv : uyvy), yuv, name);
  }
}

TEST_P(Encodings, OfPlanesHaveTheirColorsWithPadding) {
  for (const std::string name : {"nv12", "nv21", "nv24"}) {
    const int share = name == "nv24" ? 1 : 2;
    const Yuv yuv = RandomYuv(share, share);
    for (const int padding : {0, 6}) {
      std::string rows;
      for (int y = 0; y < kHeight; ++y) {
        rows.append(reinterpret_cast<const char*>(yuv.y.ptr(y)), kWidth);
        rows.append(static_cast<size_t>(padding), 'p');
      }
      for (int y = 0; y < kHeight; y += share) {
        for (int x = 0; x < kWidth; x += share) {
          const char u = static_cast<char>(yuv.u.at<uchar>(y, x));
          const char v = static_cast<char>(yuv.v.at<uchar>(y, x));
          rows += name == "nv21" ? std::string{v, u} : std::string{u, v};
        }
        rows.append(static_cast<size_t>(2 / share * padding), 'p');
      }
      ExpectYuv(Frame(name, yuv.y.size(), static_cast<uint32_t>(kWidth + padding), false, rows),
                yuv, name);
    }
  }
}

TEST(EncodingsOfOthers, AreRefusedWithTheTopicAndWhatIsRead) {
  const TempFolder folder;
  const auto recording = [&](const std::vector<std::string>& encodings) {
    std::vector<WrittenMessage> messages;
    for (const std::string& encoding : encodings)
      messages.push_back({"/cam_" + encoding + "/image_raw", "sensor_msgs/Image", kStart,
                          ImageMessage({true}, kStart, "camera", encoding,
                                       encoding == "mono8" ? TinyImage(0) : Colors16())});
    return folder.Write("walk.mcap", McapBytes({"none"}, false).Of(messages));
  };
  const std::string refused =
      MessageOf(ErrorKind::kInput, [&] { OpenSource(recording({"rgb565"})); });
  EXPECT_THAT(refused, HasSubstr("walk.mcap: /cam_rgb565/image_raw has the encoding `rgb565`"));
  EXPECT_THAT(refused, HasSubstr("read are 16UC1, "));
  EXPECT_THAT(refused, HasSubstr("bayer_grbg16"));
  // Another topic of the recording is taken instead.
  const auto source = OpenSource(recording({"rgb565", "mono8"}));
  EXPECT_EQ(cv::norm(source->Next()->image, TinyImage(0), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace alidade::encodings_test
