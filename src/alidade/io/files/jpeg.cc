#include <algorithm>
#include <csetjmp>
#include <cstdio>  // must precede jpeglib.h
#include <cstdlib>
#include <cstring>
#include <limits>
//
#include <jerror.h>
#include <jpeglib.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/image_codec.h"

namespace alidade {
namespace {

// libjpeg's error function must not return, so it calls longjmp. No object with a destructor may be
// created between setjmp and longjmp; therefore the plain functions below get all objects as
// arguments.
struct JumpingErrors {
  jpeg_error_mgr manager;
  std::jmp_buf target;
  char message[JMSG_LENGTH_MAX];
};

void JumpOut(j_common_ptr info) {
  auto* errors = reinterpret_cast<JumpingErrors*>(info->err);
  info->err->format_message(info, errors->message);
  std::longjmp(errors->target, 1);
}

// Level -1 are warnings after which libjpeg would fill the rest with gray: truncated or damaged
// data.
void OnMessage(j_common_ptr info, int level) {
  const int code = info->err->msg_code;
  if (level == -1 &&
      (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE))
    JumpOut(info);
}

// Every scan of a progressive JPEG, however short, is a pass over the whole image. Encoders write
// about ten; the limit bounds the decoding time of a crafted file.
constexpr int kMostScans = 100;

// libjpeg calls this for every row of blocks.
void OnProgress(j_common_ptr info) {
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number <= kMostScans) return;
  auto* errors = reinterpret_cast<JumpingErrors*>(info->err);
  std::snprintf(errors->message, sizeof errors->message, "it has more than %d scans", kMostScans);
  std::longjmp(errors->target, 1);
}

void Install(JumpingErrors& errors) {
  jpeg_std_error(&errors.manager);
  errors.manager.error_exit = JumpOut;
  errors.manager.emit_message = OnMessage;
  errors.message[0] = 0;
}

bool ReadHeader(jpeg_decompress_struct& info, JumpingErrors& errors, std::string_view bytes) {
  if (setjmp(errors.target)) return false;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  return true;
}

bool ReadRows(jpeg_decompress_struct& info, JumpingErrors& errors, cv::Mat& image) {
  if (setjmp(errors.target)) return false;
  jpeg_start_decompress(&info);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = image.ptr(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

class Decompressor {
 public:
  Decompressor() {
    Install(errors);
    info.err = &errors.manager;
    jpeg_create_decompress(&info);
    progress.progress_monitor = OnProgress;
    info.progress = &progress;
  }
  ~Decompressor() { jpeg_destroy_decompress(&info); }
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;

  jpeg_decompress_struct info{};
  JumpingErrors errors{};
  jpeg_progress_mgr progress{};
};

// Every 8 x 8 block needs at least one bit. This does not hold for arithmetic coding, which is
// hardly ever used.
bool IsTooShort(const jpeg_decompress_struct& info, size_t bytes) {
  size_t blocks = std::numeric_limits<size_t>::max();  // of the component with the fewest blocks
  for (int i = 0; i < info.num_components; ++i) {
    const jpeg_component_info& component = info.comp_info[i];
    blocks =
        std::min(blocks, size_t{component.width_in_blocks} * size_t{component.height_in_blocks});
  }
  return !info.arith_code && blocks / 8 > bytes;
}

struct Compressed {
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
};

bool WriteRows(jpeg_compress_struct& info, JumpingErrors& errors, const cv::Mat& image, int quality,
               Compressed& out) {
  if (setjmp(errors.target)) return false;
  jpeg_mem_dest(&info, &out.bytes, &out.size);
  info.image_width = static_cast<JDIMENSION>(image.cols);
  info.image_height = static_cast<JDIMENSION>(image.rows);
  info.input_components = image.channels();
  info.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = const_cast<unsigned char*>(image.ptr(static_cast<int>(info.next_scanline)));
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  return true;
}

// Gray is the luma as stored, equal to what JCS_GRAYSCALE decodes.
DecodedImage FromLumaAndChroma(const cv::Mat& y_cb_cr) {
  DecodedImage both;
  cv::extractChannel(y_cb_cr, both.image, 0);
  cv::Mat y_cr_cb(y_cb_cr.size(), CV_8UC3);
  cv::mixChannels({y_cb_cr}, {y_cr_cb}, {0, 0, 1, 2, 2, 1});
  cv::cvtColor(y_cr_cb, both.color, cv::COLOR_YCrCb2BGR);
  return both;
}

}  // namespace

bool LooksLikeJpeg(std::string_view bytes) { return bytes.substr(0, 3) == "\xff\xd8\xff"; }

DecodedImage DecodeJpeg(std::string_view bytes, ImageUse use) {
  if (use == ImageUse::kDepth) return {{}, "is a JPEG: depth images need 16 bits"};
  Decompressor decoder;
  const auto failed = [&] {
    return DecodedImage{{}, std::string("is a damaged JPEG: ") + decoder.errors.message};
  };
  if (!ReadHeader(decoder.info, decoder.errors, bytes)) return failed();
  const int64_t width = decoder.info.image_width, height = decoder.info.image_height;
  if (!IsPictureSize(width, height)) return {{}, "cannot be used: " + TooLargeText(width, height)};
  if (IsTooShort(decoder.info, bytes.size()))
    return {{}, "is a damaged JPEG: it is too short for its width and height"};
  const J_COLOR_SPACE stored = decoder.info.jpeg_color_space;
  const bool both = use == ImageUse::kGrayAndColor && stored != JCS_GRAYSCALE;
  if (both && stored != JCS_YCbCr) {  // rare: the file does not store luma
    DecodedImage decoded = DecodeJpeg(bytes, ImageUse::kGray);
    if (decoded.problem.empty()) decoded.color = DecodeJpeg(bytes, ImageUse::kColor).image;
    return decoded;
  }
  const bool gray = use != ImageUse::kColor && !both;
  decoder.info.out_color_space = both ? JCS_YCbCr : gray ? JCS_GRAYSCALE : JCS_EXT_BGR;
  cv::Mat image(static_cast<int>(decoder.info.image_height),
                static_cast<int>(decoder.info.image_width), gray ? CV_8UC1 : CV_8UC3);
  if (!ReadRows(decoder.info, decoder.errors, image)) return failed();
  return both ? FromLumaAndChroma(image) : DecodedImage{image, {}};
}

cv::Size JpegSize(std::string_view bytes) {
  Decompressor decoder;
  if (!ReadHeader(decoder.info, decoder.errors, bytes)) return {};
  return {static_cast<int>(decoder.info.image_width), static_cast<int>(decoder.info.image_height)};
}

std::string EncodeJpeg(const cv::Mat& image, int quality) {
  CV_Assert(image.type() == CV_8UC1 || image.type() == CV_8UC3);
  JumpingErrors errors{};
  Install(errors);
  jpeg_compress_struct info{};
  info.err = &errors.manager;
  jpeg_create_compress(&info);
  Compressed out;
  const bool written = WriteRows(info, errors, image, quality, out);
  jpeg_destroy_compress(&info);
  std::string bytes;
  if (written) bytes.assign(reinterpret_cast<const char*>(out.bytes), out.size);
  std::free(out.bytes);
  if (!written) ThrowInput(std::string("JPEG: ") + errors.message);
  return bytes;
}

}  // namespace alidade
