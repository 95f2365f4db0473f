// Images and cameras that exceed the size limits.
#include "alidade/geometry/picture_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alidade/io/calibration.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/euroc_calibration.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/files/image_file.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::picture_size_test {
namespace {

using testing::HasSubstr;

TEST(PictureSize, HasALimitForEachSideAndForBothTogether) {
  EXPECT_TRUE(IsPictureSize(1, 1));
  EXPECT_TRUE(IsPictureSize(8192, 8192));
  EXPECT_TRUE(IsPictureSize(kMostSide, 100));
  EXPECT_FALSE(IsPictureSize(8192, 8193));
  EXPECT_FALSE(IsPictureSize(kMostSide + 1, 100));
  EXPECT_FALSE(IsPictureSize(int64_t{1} << 32, int64_t{1} << 32));
  EXPECT_FALSE(IsPictureSize(0, 5));
  EXPECT_FALSE(IsPictureSize(5, -1));
}

std::string CameraText(const std::string& size) {
  return "model: fisheye\n" + size + "\nfx: 9000\nfy: 9000\ncx: 9999\ncy: 9999\n";
}

TEST(PictureSize, CamerasBeyondItAreRefusedAtTheirLine) {
  const std::string message = MessageOf(ErrorKind::kInput, [] {
    ParseCameraFile(CameraText("width: 20000\nheight: 20000"), "c.yaml");
  });
  EXPECT_THAT(message, HasSubstr("c.yaml:2: images of 20000x20000 are too large"));
  EXPECT_THAT(message, HasSubstr("scale them down"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [] {
                          ParseEurocCamera("camera_model: pinhole\nresolution: [20000, 20000]\n",
                                           "s.yaml");
                        }),
              HasSubstr("s.yaml:2: images of 20000x20000"));
}

TEST(PictureSize, NoMapsAreMadeForACameraBeyondIt) {
  Calibration calibration;
  calibration.origin = "given";
  calibration.left = {Lens::kFisheye, 20000, 20000, 9000, 9000, 9999, 9999, {}};
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ImagePreparation(calibration, Sensor::kMono); }),
              HasSubstr("given: images of 20000x20000"));
  Camera camera = Camera::FromFieldOfView(20000, 20000, 66);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { camera.Check(); }), HasSubstr("20000x20000"));
}

// A valid PNG whose header is changed to state `side` pixels each way.
std::string PngThatClaims(uint32_t side) {
  std::string bytes = EncodePng(cv::Mat(8, 8, CV_8UC1, cv::Scalar(9)));
  for (size_t i = 0; i < 8; ++i)
    bytes[16 + i] = static_cast<char>(side >> (24 - 8 * (i % 4)) & 0xff);
  uint32_t crc = 0xffffffff;  // of the chunk's name and its 13 bytes
  for (size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  crc = ~crc;
  for (size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<char>(crc >> (24 - 8 * i) & 0xff);
  return bytes;
}

std::string JpegThatClaims(uint32_t side) {
  std::string bytes = EncodeJpeg(cv::Mat(8, 8, CV_8UC1, cv::Scalar(9)), 90);
  const size_t frame = bytes.find("\xff\xc0");
  for (size_t i = 0; i < 4; ++i)
    bytes.at(frame + 5 + i) = static_cast<char>(side >> (8 - 8 * (i % 2)) & 0xff);
  return bytes;
}

TEST(PictureSize, ImagesThatClaimMoreAreRefusedByTheirHeader) {
  const TempFolder folder;
  for (const std::string& path :
       {folder.Write("a.png", PngThatClaims(20000)), folder.Write("b.jpg", JpegThatClaims(20000)),
        folder.Write("c.png", PngThatClaims(1000000))}) {
    const std::string read = MessageOf(ErrorKind::kInput, [&] { ReadImageGray(path); });
    const std::string size = MessageOf(ErrorKind::kInput, [&] { ReadImageSize(path); });
    EXPECT_THAT(read, HasSubstr(path));
    EXPECT_THAT(size, HasSubstr(path));
    if (path.find("c.png") == std::string::npos) {  // libpng's own limit is a million per side
      EXPECT_THAT(read, HasSubstr("images of 20000x20000 are too large"));
      EXPECT_THAT(size, HasSubstr("images of 20000x20000 are too large"));
    }
  }
}

// Read by OpenCV, which must not allocate memory for it first.
TEST(PictureSize, ImagesOfOtherKindsAreRefusedToo) {
  const TempFolder folder;
  const std::string path = folder.Write("a.ppm", "P5\n20000 20000\n255\n" + std::string(100, 'x'));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadImageGray(path); }), HasSubstr(path));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadImageSize(path); }), HasSubstr(path));
}

}  // namespace
}  // namespace alidade::picture_size_test
