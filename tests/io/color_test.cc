// Color images belong to the gray images that are tracked, and do not change them.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/mp4.h"
#include "support/tiny_recording.h"

namespace alidade::color_test {
namespace {

double MaxDifference(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(a.size(), b.size());
  EXPECT_EQ(a.type(), b.type());
  return cv::norm(a, b, cv::NORM_INF);
}

cv::Mat Luma(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat ColorImage(int seed, int width = kTinyWidth, int height = kTinyHeight) {
  cv::Mat planes[3], image;
  for (int i = 0; i < 3; ++i) planes[i] = TinyImage(3 * seed + i, width, height);
  cv::merge(planes, 3, image);
  return image;
}

TEST(GrayAndColor, GrayIsTheGrayReadersBitForBit) {
  const TempFolder folder;
  // Odd size: chroma has half as many samples, rounded up.
  const cv::Mat color = ColorImage(1, 61, 47);
  cv::Mat alpha;
  cv::cvtColor(color, alpha, cv::COLOR_BGR2BGRA);
  ASSERT_TRUE(cv::imwrite(folder / "a.jpg", color, {cv::IMWRITE_JPEG_QUALITY, 90}));
  ASSERT_TRUE(cv::imwrite(folder / "b.png", color));
  ASSERT_TRUE(cv::imwrite(folder / "c.png", alpha));
  ASSERT_TRUE(cv::imwrite(folder / "d.bmp", color));
  for (const char* name : {"a.jpg", "b.png", "c.png", "d.bmp"}) {
    const GrayAndColor both = ReadImageGrayAndColor(folder / name);
    EXPECT_EQ(MaxDifference(both.gray, ReadImageGray(folder / name)), 0) << name;
    // libjpeg and OpenCV round the color conversion differently.
    EXPECT_LE(MaxDifference(both.color, cv::imread(folder / name)), 2) << name;
  }
}

TEST(GrayAndColor, GrayFilesHaveNoColours) {
  const TempFolder folder;
  WriteImage(folder / "a.jpg", TinyImage(1));
  WriteImage(folder / "b.png", TinyImage(1));
  for (const char* name : {"a.jpg", "b.png"}) {
    const GrayAndColor both = ReadImageGrayAndColor(folder / name);
    EXPECT_EQ(MaxDifference(both.gray, ReadImageGray(folder / name)), 0) << name;
    EXPECT_TRUE(both.color.empty()) << name;
  }
}

TEST(GrayAndColor, DamageIsAnErrorAsInGray) {
  const TempFolder folder;
  WriteImage(folder / "whole.jpg", ColorImage(1));
  const std::string bytes = ReadFile(folder / "whole.jpg");
  const std::string half = folder.Write("half.jpg", bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(MessageOf(ErrorKind::kInput, [&] { ReadImageGrayAndColor(half); }),
            MessageOf(ErrorKind::kInput, [&] { ReadImageGray(half); }));
}

class ColorOfASource : public testing::Test {
 protected:
  // Three color JPEGs in TUM's layout.
  ColorOfASource() {
    folder_.Folder("rgb");
    std::string list;
    for (int i = 0; i < 3; ++i) {
      const std::string name = "rgb/" + std::to_string(i) + ".jpg";
      cv::Mat smooth;
      cv::GaussianBlur(ColorImage(i), smooth, {0, 0}, 3);
      WriteImage(folder_ / name, smooth);
      list += std::to_string(i) + ".0 " + name + "\n";
    }
    folder_.Write("rgb.txt", list);
  }
  void WriteCamera(const std::string& model) {
    folder_.Write("camera.yaml", "model: " + model +
                                     "\nwidth: 64\nheight: 48\nfx: 30\nfy: 30\ncx: 31\ncy: 24\n"
                                     "distortion: [0.1, 0, 0, 0]\nfps: 30\n");
  }
  // Two sources return equal frames, one of them with colors.
  void ExpectTheSameAndColours(double tolerance) {
    const auto plain = OpenSource(folder_.path()), colored = OpenSource(folder_.path(), color_);
    for (int i = 0; i < 3; ++i) {
      const auto a = plain->Next(), b = colored->Next();
      ASSERT_TRUE(a && b);
      EXPECT_TRUE(a->color.empty());
      EXPECT_EQ(MaxDifference(a->image, b->image), 0);
      EXPECT_LE(MaxDifference(Luma(b->color), b->image), tolerance);
    }
  }

  SourceOptions color_ = {.color = true};
  TempFolder folder_;
};

TEST_F(ColorOfASource, ComesBesideTheSameGrayOnlyWhenAskedFor) {
  WriteCamera("pinhole");
  ExpectTheSameAndColours(2);
}

TEST_F(ColorOfASource, IsRectifiedAsTheGrayIs) {
  WriteCamera("fisheye");
  const auto raw = ReadImageGray(folder_ / "rgb/0.jpg");
  // Fisheye images change.
  EXPECT_GT(MaxDifference(OpenSource(folder_.path())->Next()->image, raw), 6);
  ExpectTheSameAndColours(3);
}

TEST_F(ColorOfASource, GrayRecordingsHaveNone) {
  const TempFolder gray;
  WriteTinyTum(gray);
  const auto frame = OpenSource(gray.path(), color_)->Next();
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->image.empty());
  EXPECT_TRUE(frame->color.empty());
}

TEST_F(ColorOfASource, OfAVideoStandsUprightToo) {
  const std::string path = folder_ / "clip.mp4";
  cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 25,
                         {128, 48});
  cv::Mat red(48, 128, CV_8UC3, cv::Scalar(20, 30, 220));
  red.colRange(0, 64) = cv::Scalar(220, 30, 20);
  for (int i = 0; i < 3; ++i) writer.write(red);
  writer.release();
  std::string bytes = ReadFile(path);
  SetMp4QuarterTurn(bytes);
  AtomicWriteFile(path, bytes);
  WarningCatcher warnings;  // the calibration is unknown
  const auto plain = OpenSource(path)->Next(), colored = OpenSource(path, color_)->Next();
  ASSERT_TRUE(plain && colored);
  EXPECT_TRUE(plain->color.empty());
  EXPECT_EQ(MaxDifference(plain->image, colored->image), 0);
  EXPECT_EQ(MaxDifference(Luma(colored->color), colored->image), 0);
  // Clockwise quarter turn: the left side becomes the top.
  EXPECT_NEAR(cv::mean(colored->color.rowRange(4, 56))[0], 220, 15);
  EXPECT_NEAR(cv::mean(colored->color.rowRange(70, 124))[2], 220, 15);
}

}  // namespace
}  // namespace alidade::color_test
