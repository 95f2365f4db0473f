// Videos in which frames are stored in another order than they are shown.
#include <gmock/gmock.h>

#include "alidade/io/files/file.h"
#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/mp4.h"
#include "support/temp_folder.h"
#include "support/video_with_b_frames.h"

namespace alidade::video_times_test {
namespace {

// Brightness tells the number.
std::vector<cv::Mat> Images(int count) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < count; ++i)
    images.emplace_back(96, 128, CV_8UC3, cv::Scalar::all(20 + 8 * i));
  return images;
}

TEST(VideoTimes, EveryFrameHasItsOwnPresentationTime) {
  const TempFolder folder;
  // A camera that slows down in the dark: 33 ms, then 50 ms.
  std::vector<int> times;
  for (int i = 0; i < 25; ++i) times.push_back(i < 12 ? 33 * i : 33 * 12 + 50 * (i - 12));
  WriteVideoWithBFrames(folder / "clip.mp4", Images(25), times);
  const auto source = OpenSource(folder / "clip.mp4");
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < 25; ++i) {
      const auto frame = source->Next();
      ASSERT_TRUE(frame) << i;
      EXPECT_NEAR(frame->time, 1e-3 * times[static_cast<size_t>(i)], 1e-6) << i;
      EXPECT_NEAR(cv::mean(frame->image)[0], 20 + 8 * i, 4) << i;
    }
    EXPECT_FALSE(source->Next());
    ASSERT_TRUE(source->Seek(0));
  }
  ASSERT_TRUE(source->Seek(20));
  EXPECT_NEAR(source->Next()->time, 1e-3 * times[20], 1e-6);
}

// A telephone cuts a video without encoding it again: an edit list leaves frames out at both ends.
TEST(VideoTimes, OfAnEditListAreThoseOfThePartThatIsShown) {
  const TempFolder folder;
  std::vector<int> times;
  for (int i = 0; i < 25; ++i) times.push_back(40 * i);
  const std::string path = folder / "clip.mp4";
  WriteVideoWithBFrames(path, Images(25), times);
  std::string bytes = ReadFile(path);
  const size_t edits = Mp4Box(bytes, "elst");
  const double track = Mp4Number(bytes, Mp4Box(bytes, "mdhd") + 20);
  const double start = Mp4Number(bytes, edits + 20) / track;  // FFmpeg's: the first frame shown
  SetMp4Edit(bytes, start + 0.2, 0.4);
  AtomicWriteFile(path, bytes);
  WarningCatcher warnings;
  const auto source = OpenSource(path);
  EXPECT_EQ(source->Info().frames, 10);
  int frames = 0;
  while (const auto frame = source->Next()) {
    EXPECT_NEAR(frame->time, 0.04 * frames, 1e-6);
    EXPECT_NEAR(cv::mean(frame->image)[0], 20 + 8 * (frames + 5), 4);
    ++frames;
  }
  EXPECT_EQ(frames, 10);
  EXPECT_THAT(warnings.text(), testing::Not(testing::HasSubstr("truncated")));
}

}  // namespace
}  // namespace alidade::video_times_test
