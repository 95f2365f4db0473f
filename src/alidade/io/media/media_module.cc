#include "alidade/io/media/media_module.h"

#include <libexif/exif-data.h>

extern "C" {
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "alidade/io/files/image_codec.h"

namespace alidade {
namespace {

// Suppresses the libraries' messages, because Alidade reports each problem in one line. Values the
// user has set for these variables are kept.
void SilenceLibraries() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  setenv("OPENCV_FFMPEG_DEBUG", "1", 0);  // required for the next line to take effect
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
}

// Clockwise quarter turns that make the images upright.
int QuarterTurns(const cv::VideoCapture& capture) {
  const int degrees = static_cast<int>(capture.get(cv::CAP_PROP_ORIENTATION_META));
  const int turns = ((degrees / 90) % 4 + 4) % 4;
  // OpenCV 4.6.0 returns the angle with the wrong sign (its issue 22088), so portrait videos would
  // be upside down.
  const bool wrong =
      cv::getVersionMajor() == 4 && cv::getVersionMinor() == 6 && cv::getVersionRevision() == 0;
  return wrong ? (4 - turns) % 4 : turns;
}

// QuickTime metadata key that Apple phones write for the file or for a track.
constexpr char kFocalLengthKey[] = "com.apple.quicktime.camera.focal_length.35mm_equivalent";

double Millimetres(const AVDictionary* metadata) {
  const AVDictionaryEntry* entry = av_dict_get(metadata, kFocalLengthKey, nullptr, 0);
  const double value = entry ? std::strtod(entry->value, nullptr) : 0;
  return std::isfinite(value) && value > 0 ? value : 0;
}

double FocalLengthOfVideo(const char* path) {
  av_log_set_level(AV_LOG_QUIET);
  AVFormatContext* context = nullptr;
  if (avformat_open_input(&context, path, nullptr, nullptr) != 0) return 0;
  double focal = Millimetres(context->metadata);
  for (unsigned i = 0; focal == 0 && i < context->nb_streams; ++i)
    focal = Millimetres(context->streams[i]->metadata);
  avformat_close_input(&context);
  return focal;
}

class Stream : public MediaStream {
 public:
  Stream(cv::VideoCapture capture, bool live, double focal_length_35)
      : capture_(std::move(capture)),
        live_(live),
        turns_(live ? 0 : QuarterTurns(capture_)),
        focal_length_35_(focal_length_35) {}

  int FrameCount() const override {
    return live_ ? 0 : static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_COUNT));
  }
  double FramesPerSecond() const override { return capture_.get(cv::CAP_PROP_FPS); }

  double FocalLength35() const override { return focal_length_35_; }

  bool Grab() override try {
    const bool grabbed = capture_.grab();
    if (live_) {
      const auto now = Clock::now();
      if (start_ == Clock::time_point{}) start_ = now;
      time_ = std::chrono::duration<double>(now - start_).count();
    } else {
      time_ = capture_.get(cv::CAP_PROP_POS_MSEC) / 1000;
    }
    return grabbed;
  } catch (const cv::Exception&) {
    return false;
  }

  double Time() const override { return time_; }

  cv::Mat Gray() override try {
    cv::Mat color, gray;  // new buffers: the caller may still use the previous images
    color_.release();
    if (!capture_.retrieve(color) || color.empty()) return {};
    if (color.channels() == 1) {
      gray = color.clone();
    } else {
      cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
      color_ = color;
    }
    return Upright(gray);
  } catch (const cv::Exception&) {
    return {};
  }

  cv::Mat Color() override try {
    return color_.empty() ? cv::Mat() : Upright(color_);
  } catch (const cv::Exception&) {
    return {};
  }

  bool SeekNear(double time) override try {
    return !live_ && capture_.set(cv::CAP_PROP_POS_MSEC, 1000 * time);
  } catch (const cv::Exception&) {
    return false;
  }

 private:
  using Clock = std::chrono::steady_clock;

  cv::Mat Upright(const cv::Mat& image) const {
    constexpr cv::RotateFlags kTurns[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                          cv::ROTATE_90_COUNTERCLOCKWISE};
    if (turns_ == 0) return image;
    cv::Mat turned;
    cv::rotate(image, turned, kTurns[turns_ - 1]);
    return turned;
  }

  cv::VideoCapture capture_;
  bool live_;
  int turns_;
  double focal_length_35_;
  cv::Mat color_;  // color of the image that Gray() returned last
  Clock::time_point start_{};
  double time_ = 0;
};

}  // namespace
}  // namespace alidade

using namespace alidade;

extern "C" __attribute__((visibility("default"))) bool alidade_media_decode(const char* bytes,
                                                                            size_t size, int use,
                                                                            cv::Mat* image) try {
  SilenceLibraries();
  const cv::Mat buffer(1, static_cast<int>(size), CV_8UC1, const_cast<char*>(bytes));
  const auto as = static_cast<ImageUse>(use);
  *image = cv::imdecode(buffer, as == ImageUse::kGray    ? cv::IMREAD_GRAYSCALE
                                : as == ImageUse::kColor ? cv::IMREAD_COLOR
                                                         : cv::IMREAD_UNCHANGED);
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
                                                                                  int camera) try {
  SilenceLibraries();
  const bool live = path[0] == 0;
  cv::VideoCapture capture;
  if (live) {
    capture.open(camera, cv::CAP_ANY);
  } else {
    capture.open(path, cv::CAP_FFMPEG);
    capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  }
  if (!capture.isOpened()) return nullptr;
  return std::make_unique<Stream>(std::move(capture), live, live ? 0 : FocalLengthOfVideo(path))
      .release();
} catch (...) {
  return nullptr;
}
