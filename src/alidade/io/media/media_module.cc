#include "alidade/io/media/media_module.h"

#include <libexif/exif-data.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/media/packet_decoder.h"
#include "alidade/io/media/video_file.h"

namespace alidade {
namespace {

// Suppresses OpenCV's messages, because Alidade reports each problem in one line.
void SilenceLibraries() { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); }

}  // namespace
}  // namespace alidade

using namespace alidade;

extern "C" __attribute__((visibility("default"))) bool alidade_media_decode(const char* bytes,
                                                                            size_t size, int use,
                                                                            cv::Mat* image) try {
  SilenceLibraries();
  const cv::Mat buffer(1, static_cast<int>(size), CV_8UC1, const_cast<char*>(bytes));
  const auto as = static_cast<ImageUse>(use);
  *image = cv::imdecode(buffer, as == ImageUse::kGray ? cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH
                                : as == ImageUse::kColor ? cv::IMREAD_COLOR
                                                         : cv::IMREAD_UNCHANGED);
  if (as == ImageUse::kGray && image->depth() != CV_8U && image->depth() != CV_16U)
    *image = cv::imdecode(buffer, cv::IMREAD_GRAYSCALE);
  return !image->empty();
} catch (...) {
  return false;
}

extern "C" __attribute__((visibility("default"))) double alidade_media_focal(const char* bytes,
                                                                             size_t size) try {
  ExifData* data = exif_data_new_from_data(reinterpret_cast<const unsigned char*>(bytes),
                                           static_cast<unsigned>(std::min(size, size_t{1} << 30)));
  if (!data) return 0;
  const ExifEntry* entry = exif_data_get_entry(data, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM);
  const bool there = entry && entry->format == EXIF_FORMAT_SHORT && entry->size >= 2;
  const double focal = there ? exif_get_short(entry->data, exif_data_get_byte_order(data)) : 0;
  exif_data_unref(data);
  return focal;
} catch (...) {
  return 0;
}

extern "C" __attribute__((visibility("default"))) MediaStream* alidade_media_open(const char* path,
                                                                                  bool live) try {
  return OpenVideoFile(path, live).release();
} catch (...) {
  return nullptr;
}

extern "C" __attribute__((visibility("default"))) PacketDecoder* alidade_media_packets(
    PacketCodec codec) try {
  return MakePacketDecoder(codec).release();
} catch (...) {
  return nullptr;
}
