// Lens metadata of recordings: EXIF data of images, QuickTime metadata of videos.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/files/open_source.h"
#include "support/exif.h"
#include "support/temp_folder.h"

namespace alidade::lens_told_test {
namespace {

std::string Picture(int width, int height, const std::string& exif) {
  const cv::Mat image(height, width, CV_8U, cv::Scalar(90));
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", image, jpeg);
  const std::string text(jpeg.begin(), jpeg.end());
  return text.substr(0, 2) + exif + text.substr(2);
}

std::string Box(const std::string& name, const std::string& body) {
  return Big(static_cast<uint32_t>(body.size()) + 8, 4) + name + body;
}

// Writes a video and appends QuickTime metadata to its last box, moov.
void WriteVideo(const std::string& path, const std::string& millimetres) {
  cv::VideoWriter video(path, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30, {64, 48});
  ASSERT_TRUE(video.isOpened());
  for (int i = 0; i < 5; ++i) video.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40 * i)));
  video.release();
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  in.close();
  const size_t moov = bytes.rfind("moov");
  ASSERT_NE(moov, std::string::npos);
  const std::string key = "com.apple.quicktime.camera.focal_length.35mm_equivalent";
  const std::string hdlr = Box("hdlr", Big(0, 8) + "mdta" + Big(0, 12) + Big(0, 1));
  const std::string keys = Box("keys", Big(0, 4) + Big(1, 4) + Box("mdta", key));
  const std::string data = Box("data", Big(1, 4) + Big(0, 4) + millimetres);
  const std::string meta = Box("meta", hdlr + keys + Box("ilst", Box(Big(1, 4), data)));
  bytes.replace(moov - 4, 4,
                Big(static_cast<uint32_t>(bytes.size() - (moov - 4) + meta.size()), 4));
  std::ofstream(path, std::ios::binary) << bytes << meta;
}

// For an image of 4:3 the diagonal is 5/4 of the width.
double FovOf(double millimetres) {
  return 360 / M_PI * std::atan(43.266615 / (2 * 1.25 * millimetres));
}
double FovOf(const SourceInfo& info) {
  return 360 / M_PI * std::atan(info.camera.width / (2 * info.camera.fx));
}

TEST(LensTold, ByEachImagesExifDataWhereNothingIsKnown) {
  const TempFolder folder;
  folder.Write("a.jpg", Picture(640, 480, Exif(26)));
  folder.Write("b.jpg", Picture(640, 480, ""));
  const auto source = OpenSource(folder.path(), {});
  EXPECT_TRUE(source->Info().camera_guessed);
  EXPECT_THAT(source->Info().lens_told, testing::HasSubstr("26 mm"));
  EXPECT_NEAR(FovOf(source->Info()), FovOf(26), 1e-6);

  SourceOptions given;
  given.fov_degrees = 80;
  EXPECT_NEAR(FovOf(OpenSource(folder.path(), given)->Info()), 80, 1e-6);
  EXPECT_EQ(OpenSource(folder.path(), given)->Info().lens_told, "");
}

TEST(LensTold, AnUprightPictureHasTheSameLens) {
  const TempFolder folder;
  folder.Write("a.jpg", Picture(480, 640, Exif(26)));
  const auto info = OpenSource(folder.path(), {})->Info();
  EXPECT_NEAR(info.camera.fx, 26 / 43.266615 * 800, 0.01);
}

TEST(LensTold, NonsenseIsNotBelieved) {
  for (const std::string& exif :
       {Exif(0), Exif(1), Exif(60000), Exif(26).substr(0, 30), std::string()}) {
    const TempFolder folder;
    folder.Write("a.jpg", Picture(640, 480, exif.size() == 30 ? std::string() : exif));
    const auto source = OpenSource(folder.path(), {});
    EXPECT_EQ(source->Info().lens_told, "");
    EXPECT_NEAR(FovOf(source->Info()), 66, 1e-6);
  }
}

TEST(LensTold, ByVideos) {
  const TempFolder folder;
  WriteVideo(folder / "walk.mp4", "24");
  const auto source = OpenSource(folder / "walk.mp4", {});
  EXPECT_THAT(source->Info().lens_told, testing::HasSubstr("24 mm"));
  EXPECT_NEAR(FovOf(source->Info()), FovOf(24), 1e-6);
  WriteVideo(folder / "none.mp4", "wide");
  EXPECT_EQ(OpenSource(folder / "none.mp4", {})->Info().lens_told, "");
}

}  // namespace
}  // namespace alidade::lens_told_test
