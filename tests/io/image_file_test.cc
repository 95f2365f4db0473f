#include "alidade/io/files/image_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/base/random.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::image_file_test {
namespace {

double MaxDifference(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(a.size(), b.size());
  EXPECT_EQ(a.type(), b.type());
  return cv::norm(a, b, cv::NORM_INF);
}

cv::Mat ColorImage() {
  cv::Mat planes[3] = {TinyImage(1), TinyImage(2), TinyImage(3)}, image;
  cv::merge(planes, 3, image);
  return image;
}

TEST(ImageFile, PngComesBackBitForBitAndAsOpencvReadsIt) {
  const TempFolder folder;
  const cv::Mat gray = TinyImage(1), color = ColorImage();
  cv::Mat depth;
  gray.convertTo(depth, CV_16U, 201.0, 3);
  WriteImage(folder / "gray.png", gray);
  WriteImage(folder / "color.png", color);
  WriteImage(folder / "depth.png", depth);
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "gray.png"), gray), 0);
  EXPECT_EQ(MaxDifference(ReadImageColor(folder / "color.png"), color), 0);
  EXPECT_EQ(MaxDifference(ReadDepth(folder / "depth.png"), depth), 0);
  EXPECT_EQ(MaxDifference(cv::imread(folder / "gray.png", cv::IMREAD_UNCHANGED), gray), 0);
  EXPECT_EQ(MaxDifference(cv::imread(folder / "color.png", cv::IMREAD_UNCHANGED), color), 0);
  EXPECT_EQ(MaxDifference(cv::imread(folder / "depth.png", cv::IMREAD_UNCHANGED), depth), 0);
}

TEST(ImageFile, GrayOfColoursIsThatOfBt601) {
  const TempFolder folder;
  const cv::Mat color = ColorImage();
  cv::Mat expected;
  cv::cvtColor(color, expected, cv::COLOR_BGR2GRAY);
  WriteImage(folder / "color.png", color);
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "color.png"), expected), 0);
  ASSERT_TRUE(cv::imwrite(folder / "color.jpg", color, {cv::IMWRITE_JPEG_QUALITY, 98}));
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "color.jpg"),
                          cv::imread(folder / "color.jpg", cv::IMREAD_GRAYSCALE)),
            0);
}

TEST(ImageFile, JpegAgreesWithOpencv) {
  const TempFolder folder;
  cv::Mat gray = TinyImage(1), color = ColorImage();
  cv::GaussianBlur(color, color, {0, 0}, 3);
  WriteImage(folder / "gray.jpg", gray);
  WriteImage(folder / "color.jpg", color);
  EXPECT_LE(MaxDifference(ReadImageGray(folder / "gray.jpg"), gray), 12);
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "gray.jpg"),
                          cv::imread(folder / "gray.jpg", cv::IMREAD_GRAYSCALE)),
            0);
  EXPECT_EQ(MaxDifference(ReadImageColor(folder / "color.jpg"), cv::imread(folder / "color.jpg")),
            0);
}

TEST(ImageFile, PalettesAlphaAndSixteenBitsBecomeGray) {
  const TempFolder folder;
  const cv::Mat color = ColorImage();
  cv::Mat with_alpha, expected, wide;
  cv::cvtColor(color, with_alpha, cv::COLOR_BGR2BGRA);
  cv::cvtColor(color, expected, cv::COLOR_BGR2GRAY);
  ASSERT_TRUE(cv::imwrite(folder / "alpha.png", with_alpha));
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "alpha.png"), expected), 0);
  TinyImage(5).convertTo(wide, CV_16U, 257);
  ASSERT_TRUE(cv::imwrite(folder / "wide.png", wide));
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "wide.png"), TinyImage(5)), 0);
  const cv::Mat binary = TinyImage(6) > 128;
  ASSERT_TRUE(cv::imwrite(folder / "binary.png", binary, {cv::IMWRITE_PNG_BILEVEL, 1}));
  EXPECT_EQ(MaxDifference(ReadImageGray(folder / "binary.png"), binary), 0);
}

// A PNG chunk: length, name, bytes, and a CRC of name and bytes.
std::string PngChunk(const std::string& name, const std::string& bytes) {
  const auto big_endian = [](size_t value) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift);
    return text;
  };
  const std::string named = name + bytes;
  return big_endian(bytes.size()) + named +
         big_endian(crc32(0, reinterpret_cast<const Bytef*>(named.data()),
                          static_cast<uInt>(named.size())));
}

// The transparency of a palette is a separate chunk. Such images used to be decoded with four
// channels.
TEST(ImageFile, TransparentPalettesBecomeGrayAndColor) {
  const std::string corpus = ALIDADE_FUZZ_CORPUS "/png/good-palette-transparent";
  EXPECT_EQ(ReadImageGray(corpus).type(), CV_8UC1);
  EXPECT_EQ(ReadImageColor(corpus).type(), CV_8UC3);
  const GrayAndColor both = ReadImageGrayAndColor(corpus);
  EXPECT_EQ(both.gray.type(), CV_8UC1);
  EXPECT_EQ(both.color.type(), CV_8UC3);
}

// A file of a few bytes cannot hold millions of pixels; this is detected before memory is
// allocated.
TEST(ImageFile, TooShortForWhatTheirHeadersClaim) {
  const TempFolder folder;
  WriteImage(folder / "a.png", TinyImage(1));
  std::string png = ReadFile(folder / "a.png");
  const std::string huge =  // 8192 x 8192, 8-bit gray
      PngChunk("IHDR", std::string("\0\0\x20\0\0\0\x20\0\x08\0\0\0\0", 13));
  png.replace(8, huge.size(), huge);
  EXPECT_THAT(DecodePng(png, ImageUse::kGray).problem, testing::HasSubstr("too short"));
  WriteImage(folder / "a.jpg", TinyImage(1));
  std::string jpeg = ReadFile(folder / "a.jpg");
  const size_t frame = jpeg.find("\xff\xc0");
  jpeg.replace(frame + 5, 4, std::string("\x20\0\x20\0", 4));
  EXPECT_THAT(DecodeJpeg(jpeg, ImageUse::kGray).problem, testing::HasSubstr("too short"));
}

// Every scan is a pass over the image. Progressive JPEGs have about ten; a crafted file can have
// hundreds.
TEST(ImageFile, JpegsOfHundredsOfScansAreRefused) {
  std::vector<uchar> made;
  ASSERT_TRUE(cv::imencode(".jpg", TinyImage(1), made, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  std::string jpeg(made.begin(), made.end());
  ASSERT_EQ(DecodeJpeg(jpeg, ImageUse::kGray).problem, "");
  const size_t first = jpeg.find("\xff\xda"), second = jpeg.find("\xff\xda", first + 2);
  const std::string scan = jpeg.substr(first, second - first);
  for (int i = 0; i < 200; ++i) jpeg.insert(first, scan);
  EXPECT_THAT(DecodeJpeg(jpeg, ImageUse::kGray).problem, testing::HasSubstr("more than 100 scans"));
}

long PeakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

// Comments may unpack to a thousand times their size, and a file may contain a thousand of them.
TEST(ImageFile, CommentsOfPngsAreNotUnpacked) {
  const TempFolder folder;
  WriteImage(folder / "a.png", TinyImage(1));
  std::string png = ReadFile(folder / "a.png");
  const std::string words(7'000'000, 'a');
  uLongf length = compressBound(words.size());
  std::string packed(length, '\0');
  ASSERT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &length,
                     reinterpret_cast<const Bytef*>(words.data()), words.size()),
            Z_OK);
  const std::string comment =
      PngChunk("zTXt", "Comment" + std::string(2, '\0') + packed.substr(0, length));
  constexpr size_t kBehindHeader = 33;
  for (int i = 0; i < 30; ++i) png.insert(kBehindHeader, comment);  // 210 MB
  const long before = PeakMegabytes();
  EXPECT_EQ(DecodePng(png, ImageUse::kColor).problem, "");
  EXPECT_LT(PeakMegabytes() - before, 60);
}

TEST(ImageFile, SizeIsThatOfTheHeader) {
  const TempFolder folder;
  WriteImage(folder / "a.png", TinyImage(1, 33, 21));
  WriteImage(folder / "a.jpg", TinyImage(1, 35, 22));
  EXPECT_EQ(ReadImageSize(folder / "a.png"), cv::Size(33, 21));
  EXPECT_EQ(ReadImageSize(folder / "a.jpg"), cv::Size(35, 22));
}

TEST(ImageFile, CutShortAnywhereIsAnErrorNeverAHalfGrayPicture) {
  const TempFolder folder;
  for (const std::string name : {"a.png", "a.jpg"}) {
    WriteImage(folder / name, TinyImage(1));
    const std::string bytes = ReadFile(folder / name);
    for (const double part : {0.0, 0.001, 0.02, 0.3, 0.6, 0.95}) {
      const std::string cut =
          folder.Write(name, bytes.substr(0, static_cast<size_t>(part * bytes.size())));
      EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadImageGray(cut); }),
                  testing::HasSubstr(cut))
          << part;
    }
  }
}

TEST(ImageFile, DamageInTheMiddleOfAPngIsAnError) {
  const TempFolder folder;
  WriteImage(folder / "a.png", TinyImage(1));
  std::string bytes = ReadFile(folder / "a.png");
  bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
  folder.Write("a.png", bytes);
  MessageOf(ErrorKind::kInput, [&] { ReadImageGray(folder / "a.png"); });
}

// Damaged files give an image or an error text but never crash (checked by the sanitizers).
TEST(ImageFile, NoDamageBringsTheReaderDown) {
  const TempFolder folder;
  Random random(11);
  for (const std::string name : {"a.png", "a.jpg"}) {
    WriteImage(folder / name, TinyImage(1));
    const std::string bytes = ReadFile(folder / name);
    int damaged = 0;
    for (int round = 0; round < 300; ++round) {
      std::string broken = bytes;
      // Even rounds damage any byte, odd rounds the header.
      const auto reach = static_cast<uint32_t>(round % 2 == 0 ? bytes.size() : 64);
      for (int i = 0; i < 3; ++i)
        broken[random.Below(reach)] = static_cast<char>(random.Below(256));
      for (const ImageUse use : {ImageUse::kGray, ImageUse::kColor, ImageUse::kDepth}) {
        const DecodedImage decoded =
            name == "a.png" ? DecodePng(broken, use) : DecodeJpeg(broken, use);
        EXPECT_NE(decoded.image.empty(), decoded.problem.empty());
        damaged += decoded.problem.empty() ? 0 : 1;
      }
    }
    EXPECT_GT(damaged, 100);
  }
}

TEST(ImageFile, NoiseIsNoImage) {
  const TempFolder folder;
  MessageOf(ErrorKind::kInput,
            [&] { ReadImageGray(folder.Write("a.png", "not an image at all")); });
  MessageOf(ErrorKind::kUsage, [&] { WriteImage(folder / "a.xyz", TinyImage(1)); });
  MessageOf(ErrorKind::kInput, [&] { WriteImage(folder / "missing/a.png", TinyImage(1)); });
}

}  // namespace
}  // namespace alidade::image_file_test
