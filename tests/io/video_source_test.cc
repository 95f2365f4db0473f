#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "alidade/io/files/file.h"
#include "alidade/io/files/open_source.h"
#include "alidade/io/wrappers.h"
#include "support/expect_error.h"
#include "support/mp4.h"
#include "support/tiny_recording.h"

namespace alidade::video_source_test {
namespace {

// An image that survives compression: eight stripes encode the number in binary; the top left
// quarter is black.
cv::Mat Picture(int number) {
  cv::Mat image(48, 128, CV_8UC3, cv::Scalar::all(128));
  image(cv::Rect(0, 0, 64, 24)) = cv::Scalar::all(0);
  for (int bit = 0; bit < 8; ++bit) {
    image(cv::Rect(16 * bit, 24, 16, 24)) = cv::Scalar::all((number >> bit) & 1 ? 255 : 0);
  }
  return image;
}
int NumberOf(const cv::Mat& image) {
  int number = 0;
  for (int bit = 0; bit < 8; ++bit)
    number |= image.at<uchar>(36, 16 * bit + 8) > 128 ? 1 << bit : 0;
  return number;
}

std::string WriteVideo(const TempFolder& folder, int frames, double fps = 25) {
  const std::string path = folder / "clip.mp4";
  cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), fps,
                         {128, 48});
  EXPECT_TRUE(writer.isOpened());
  for (int i = 0; i < frames; ++i) writer.write(Picture(i));
  return path;
}

TEST(VideoSource, GivesThePicturesAtTheirTimes) {
  const TempFolder folder;
  WarningCatcher warnings;
  const auto source = OpenSource(WriteVideo(folder, 20));
  EXPECT_EQ(source->Info().kind, "video");
  EXPECT_EQ(source->Info().name, "clip");
  EXPECT_EQ(source->Info().frames, 20);
  EXPECT_EQ(source->Info().camera.fps, 25);
  EXPECT_TRUE(source->Info().camera_guessed);
  for (int i = 0; i < 20; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->number, i);
    EXPECT_NEAR(frame->time, 0.04 * i, 1e-6);
    EXPECT_EQ(NumberOf(frame->image), i);
  }
  EXPECT_FALSE(source->Next());
}

// Durations of 1, 2, 3, 1, 2, 3, ... half frames, so that the total duration, which the file states
// elsewhere too, is unchanged.
std::vector<double> MakeVariable(const std::string& path, int frames) {
  std::string bytes = ReadFile(path);
  const size_t stts = Mp4Box(bytes, "stts");
  const uint32_t tick = Mp4Number(bytes, stts + 20);  // of its only entry
  const uint32_t scale = Mp4Number(bytes, Mp4Box(bytes, "mdhd") + 20);
  std::vector<uint32_t> durations;
  std::vector<double> times;
  double time = 0;
  for (int i = 0; i < frames; ++i) {
    times.push_back(time);
    durations.push_back(tick / 2 * static_cast<uint32_t>(1 + i % 3));
    time += static_cast<double>(durations.back()) / scale;
  }
  SetMp4Durations(bytes, durations);
  AtomicWriteFile(path, bytes);
  return times;
}

TEST(VideoSource, TimesOfAVariableRateAreThoseOfTheFile) {
  const TempFolder folder;
  WarningCatcher warnings;
  const std::string path = WriteVideo(folder, 12);
  const auto times = MakeVariable(path, 12);
  const auto source = OpenSource(path);
  for (int i = 0; i < 12; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame) << i;
    EXPECT_NEAR(frame->time, times[static_cast<size_t>(i)], 1e-6);
    EXPECT_EQ(NumberOf(frame->image), i);
  }
}

// Regression test: half a minute of a phone's video was stretched to a whole minute.
TEST(VideoSource, ARepeatedTimeMovesNoOtherWhateverCalibrationIsGiven) {
  const TempFolder folder;
  WarningCatcher warnings;
  const std::string path = WriteVideo(folder, 20, 50);
  std::string bytes = ReadFile(path);
  const uint32_t tick = Mp4Number(bytes, Mp4Box(bytes, "stts") + 20);
  std::vector<uint32_t> durations(20, tick);
  durations[4] = 0;
  durations[18] = 2 * tick;
  SetMp4Durations(bytes, durations);
  AtomicWriteFile(path, bytes);
  AtomicWriteFile(folder / "lens.yaml",
                  "model: pinhole\nwidth: 128\nheight: 48\nfx: 100\nfy: 100\ncx: 64\ncy: 24\n");
  for (const SourceOptions& options : {SourceOptions{}, SourceOptions{.fov_degrees = 60},
                                       SourceOptions{.camera_file = folder / "lens.yaml"}}) {
    const auto source = OpenSource(path, options);
    double before = -1;
    for (int i = 0; i < 20; ++i) {
      const auto frame = source->Next();
      ASSERT_TRUE(frame) << i;
      EXPECT_GT(frame->time, before);
      before = frame->time;
      if (i == 5) {
        EXPECT_NEAR(frame->time, 0.09, 1e-6) << "between its neighbours";
      } else {
        EXPECT_NEAR(frame->time, 0.02 * (i <= 4 ? i : i == 19 ? 19 : i - 1), 1e-6) << i;
      }
    }
  }
}

TEST(VideoSource, PlaysBackwardsFrameByFrameAtAVariableRate) {
  const TempFolder folder;
  WarningCatcher warnings;
  const int frames = 39;  // more than a block and a group of pictures
  const std::string path = WriteVideo(folder, frames);
  MakeVariable(path, frames);
  const auto source = Repeat(OpenSource(path), 1);
  for (int i = 0; i < 2 * frames - 1; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame) << i;
    EXPECT_EQ(NumberOf(frame->image), i < frames ? i : 2 * frames - 2 - i) << i;
  }
  EXPECT_FALSE(source->Next());
}

TEST(VideoSource, StandsUprightByTheRotationFlag) {
  const TempFolder folder;
  WarningCatcher warnings;
  const std::string path = WriteVideo(folder, 3);
  std::string bytes = ReadFile(path);
  SetMp4QuarterTurn(bytes);
  AtomicWriteFile(path, bytes);
  const auto source = OpenSource(path);
  const auto frame = source->Next();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->image.size(), cv::Size(48, 128));
  // The assumed field of view refers to the longer side.
  EXPECT_NEAR(source->Info().camera.fx, 64 / std::tan(33 * M_PI / 180), 1e-9);
  // Clockwise quarter turn: the top left corner becomes the top right one.
  EXPECT_LT(cv::mean(frame->image(cv::Rect(28, 4, 16, 56)))[0], 20);
  EXPECT_NEAR(cv::mean(frame->image(cv::Rect(28, 68, 16, 56)))[0], 128, 10);
}

// All eight ways to show an image that keep its sides parallel.
TEST(VideoSource, IsShownAsTheDisplayMatrixSays) {
  const TempFolder folder;
  WarningCatcher warnings;
  const std::string path = WriteVideo(folder, 3), bytes = ReadFile(path);
  const cv::Mat stored = OpenSource(path)->Next()->image;
  for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{{1, 0, 0, 1},
                                                                  {0, 1, -1, 0},
                                                                  {-1, 0, 0, -1},
                                                                  {0, -1, 1, 0},
                                                                  {-1, 0, 0, 1},
                                                                  {1, 0, 0, -1},
                                                                  {0, 1, 1, 0},
                                                                  {0, -1, -1, 0}}) {
    std::string changed = bytes;
    SetMp4DisplayMatrix(changed, a, b, c, d);
    AtomicWriteFile(path, changed);
    const auto frame = OpenSource(path, {.color = true})->Next();
    ASSERT_TRUE(frame);
    const int right = stored.cols - 1, bottom = stored.rows - 1;
    ASSERT_EQ(frame->image.size(), a == 0 ? cv::Size(48, 128) : cv::Size(128, 48));
    ASSERT_EQ(frame->color.size(), frame->image.size());
    // The shown image begins at 0: a negative factor counts from the other end.
    const int x0 = (a < 0 ? right : 0) + (c < 0 ? bottom : 0);
    const int y0 = (b < 0 ? right : 0) + (d < 0 ? bottom : 0);
    for (int y = 0; y <= bottom; ++y) {
      for (int x = 0; x <= right; ++x) {
        const cv::Point at(a * x + c * y + x0, b * x + d * y + y0);
        ASSERT_EQ(frame->image.at<uchar>(at), stored.at<uchar>(y, x)) << a << b << c << d;
      }
    }
  }
}

TEST(VideoSource, FirstAndLastCountFrames) {
  const TempFolder folder;
  WarningCatcher warnings;
  const std::string path = WriteVideo(folder, 10);
  const auto source = OpenSource(path, {.first = 4, .last = 6});
  for (int i = 4; i <= 6; ++i) {
    const auto frame = source->Next();
    EXPECT_EQ(frame->number, i);
    EXPECT_EQ(NumberOf(frame->image), i);
  }
  EXPECT_FALSE(source->Next());
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(path, {.first = 10}); }),
              testing::HasSubstr("past the end"));
}

TEST(VideoSource, FilesThatAreNoVideoAndCamerasThatAreNotThereSaySo) {
  const TempFolder folder;
  const std::string text = folder.Write("a.mp4", "no video");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(text); }),
              testing::HasSubstr("a.mp4 cannot be opened"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { OpenSource("camera:97"); }),
              testing::HasSubstr("/dev/video97"));
  MessageOf(ErrorKind::kUsage, [] { OpenSource("camera:front"); });
  const std::string path = WriteVideo(folder, 2);
  MessageOf(ErrorKind::kUsage, [&] { OpenSource(path, {.sensor = Sensor::kStereo}); });
}

TEST(VideoSource, ThatIsCutShortWarnsOfIt) {
  const TempFolder folder;
  WarningCatcher warnings;
  const std::string path = folder / "clip.avi";  // a truncated MP4 would lack its index
  {
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                           {128, 48});
    for (int i = 0; i < 20; ++i) writer.write(Picture(i));
  }
  const std::string bytes = ReadFile(path);
  AtomicWriteFile(path, bytes.substr(0, bytes.size() * 3 / 4));
  const auto source = OpenSource(path);
  int good = 0;
  while (const auto frame = source->Next()) good += frame->problem.empty() ? 1 : 0;
  EXPECT_GT(good, 5);
  EXPECT_LT(good, 18);
  EXPECT_THAT(warnings.text(), testing::HasSubstr("of 20 frames"));
}

TEST(MediaModule, ReadsTheOtherImageFormats) {
  const TempFolder folder;
  std::string pgm = "P5\n64 48\n255\n";
  const cv::Mat image = TinyImage(1);
  pgm.append(reinterpret_cast<const char*>(image.data), image.total());
  EXPECT_EQ(cv::norm(ReadImageGray(folder.Write("a.pgm", pgm)), image, cv::NORM_INF), 0);
  EXPECT_EQ(ReadImageSize(folder / "a.pgm"), cv::Size(64, 48));
}

}  // namespace
}  // namespace alidade::video_source_test
