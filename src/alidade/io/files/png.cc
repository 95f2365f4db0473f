#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <new>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/image_codec.h"

namespace alidade {
namespace {

// Largest expansion factor of Deflate (zlib, "Technical Details").
constexpr size_t kMostInflated = 1032;

struct Trouble {
  char message[160] = "";
};

// libpng's error function must not return, so it calls longjmp. No object with a destructor may be
// created between setjmp and longjmp; therefore the plain functions below get all objects as
// arguments.
void OnError(png_structp png, png_const_charp message) {
  auto* trouble = static_cast<Trouble*>(png_get_error_ptr(png));
  std::strncpy(trouble->message, message, sizeof trouble->message - 1);
  png_longjmp(png, 1);
}
void OnWarning(png_structp, png_const_charp) {
}  // warnings, for example about color profiles, do not concern the pixels

struct Reader {
  std::string_view rest;
};

void ReadBytes(png_structp png, png_bytep out, size_t count) {
  auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
  if (count > reader->rest.size()) png_error(png, "the file is truncated");
  std::memcpy(out, reader->rest.data(), count);
  reader->rest.remove_prefix(count);
}

void WriteBytes(png_structp png, png_bytep bytes, size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), count);
}
void Flush(png_structp) {}

class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : reader{bytes} {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &trouble, OnError, OnWarning);
    info = png_create_info_struct(png);
    if (info == nullptr) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &reader, ReadBytes);
    // Skip comments, color profiles and other chunks: a small file can hold a thousand of them that
    // unpack to 8 MB each.
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  }
  ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  Trouble trouble;
  Reader reader;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

bool ReadHeader(Decoder& decoder) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_read_info(decoder.png, decoder.info);
  return true;
}

// Configures libpng to deliver samples as `use` requires; false after an error.
bool SetUp(Decoder& decoder, ImageUse use) {
  png_structp png = decoder.png;
  if (setjmp(png_jmpbuf(png))) return false;
  const int color = png_get_color_type(png, decoder.info);
  const int bits = png_get_bit_depth(png, decoder.info);
  if (color == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (color == PNG_COLOR_TYPE_GRAY && bits < 8) png_set_expand_gray_1_2_4_to_8(png);
  png_set_strip_alpha(png);  // also the transparency chunk of palettes
  const bool keep_16 =
      use == ImageUse::kDepth || (use != ImageUse::kColor && (color & PNG_COLOR_MASK_COLOR) == 0);
  if (bits == 16 && !keep_16) png_set_scale_16(png);
  if (bits == 16 && keep_16 && std::endian::native == std::endian::little) png_set_swap(png);
  if (color & PNG_COLOR_MASK_COLOR) png_set_bgr(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, decoder.info);
  return true;
}

bool ReadRows(Decoder& decoder, png_bytepp rows) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_read_image(decoder.png, rows);
  png_read_end(decoder.png, nullptr);
  return true;
}

std::vector<png_bytep> RowsOf(const cv::Mat& image) {
  std::vector<png_bytep> rows(static_cast<size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y)
    rows[static_cast<size_t>(y)] = const_cast<png_bytep>(image.ptr(y));
  return rows;
}

bool WriteRows(png_structp png, png_infop info, const cv::Mat& image, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  const int bits = image.depth() == CV_16U ? 16 : 8;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols),
               static_cast<png_uint_32>(image.rows), bits,
               image.channels() == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Recordings have thousands of images: level 1 is several times faster than the default 6 for
  // about a tenth more bytes.
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, bits == 16 ? PNG_FILTER_NONE : PNG_FILTER_SUB);
  png_write_info(png, info);
  if (image.channels() == 3) png_set_bgr(png);
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  png_write_image(png, rows);
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

bool LooksLikePng(std::string_view bytes) { return bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n"; }

DecodedImage DecodePng(std::string_view bytes, ImageUse use) {
  Decoder decoder(bytes);
  const auto failed = [&] {
    return DecodedImage{{}, std::string("is a damaged PNG: ") + decoder.trouble.message};
  };
  if (!ReadHeader(decoder)) return failed();
  // A damaged header may state any size: check it before allocating rows.
  const int64_t width = png_get_image_width(decoder.png, decoder.info);
  const int64_t height = png_get_image_height(decoder.png, decoder.info);
  if (!IsPictureSize(width, height)) return {{}, "cannot be used: " + TooLargeText(width, height)};
  const size_t unpacked = png_get_rowbytes(decoder.png, decoder.info) * static_cast<size_t>(height);
  if (unpacked / kMostInflated > bytes.size())
    return {{}, "is a damaged PNG: it is too short for its width and height"};
  if (!SetUp(decoder, use)) return failed();
  const int channels = png_get_channels(decoder.png, decoder.info);
  const int depth = png_get_bit_depth(decoder.png, decoder.info) == 16 ? CV_16U : CV_8U;
  if (use == ImageUse::kDepth && channels != 1)
    return {{}, "is a color image: depth images have one channel"};
  cv::Mat image(static_cast<int>(png_get_image_height(decoder.png, decoder.info)),
                static_cast<int>(png_get_image_width(decoder.png, decoder.info)),
                CV_MAKETYPE(depth, channels));
  auto rows = RowsOf(image);
  if (!ReadRows(decoder, rows.data())) return failed();
  if (use == ImageUse::kGray && channels == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  if (use == ImageUse::kColor && channels == 1) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
  if (use == ImageUse::kDepth && depth == CV_8U) return {{}, kDepthOf8Bits};
  if (use == ImageUse::kGrayAndColor && channels == 3) {
    DecodedImage both{{}, {}, image};
    cv::cvtColor(image, both.image, cv::COLOR_BGR2GRAY);
    return both;
  }
  return {image, {}};
}

cv::Size PngSize(std::string_view bytes) {
  Decoder decoder(bytes);
  if (!ReadHeader(decoder)) return {};
  return {static_cast<int>(png_get_image_width(decoder.png, decoder.info)),
          static_cast<int>(png_get_image_height(decoder.png, decoder.info))};
}

std::string EncodePng(const cv::Mat& image) {
  CV_Assert(image.type() == CV_8UC1 || image.type() == CV_8UC3 || image.type() == CV_16UC1);
  Trouble trouble;
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &trouble, OnError, OnWarning);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &bytes, WriteBytes, Flush);
  auto rows = RowsOf(image);
  const bool written = WriteRows(png, info, image, rows.data());
  png_destroy_write_struct(&png, &info);
  if (!written) ThrowInput(std::string("PNG: ") + trouble.message);
  return bytes;
}

}  // namespace alidade
