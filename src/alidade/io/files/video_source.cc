#include "alidade/io/files/video_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/calibration_beside.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/files/media.h"
#include "alidade/io/trajectory.h"

namespace alidade {
namespace {

// Up to this many consecutive frames whose time does not increase are treated as isolated errors,
// which phones and screen recorders make; after more, the stream's clock is considered stopped or
// restarted.
constexpr int kMostRepeated = 2;
// Share of a frame's period: a smaller step is no step. Encoders write steps of one tick for frames
// whose times they do not know.
constexpr double kLeastStep = 0.1;

class VideoSource : public FrameSource {
 public:
  // `stream` has grabbed its first frame.
  VideoSource(SourceInfo info, std::string path, std::unique_ptr<MediaStream> stream,
              ImagePreparation preparation, cv::Size raw_size, bool color)
      : info_(std::move(info)),
        path_(std::move(path)),
        stream_(std::move(stream)),
        preparation_(std::move(preparation)),
        raw_size_(raw_size),
        color_(color) {}

  const SourceInfo& Info() const override { return info_; }

  std::optional<SourceFrame> Next() override {
    if (!GrabNext()) return std::nullopt;
    SourceFrame frame;
    frame.number = next_;
    frame.time = times_[static_cast<size_t>(next_)];
    frame.stamp = FormatTime(frame.time);
    const cv::Mat image = stream_->Gray();
    const cv::Mat color = color_ ? stream_->Color() : cv::Mat();
    Advance();
    if (image.empty()) {
      frame.problem = info_.name + ": frame " + std::to_string(frame.number) + " cannot be decoded";
    } else if (image.size() != raw_size_) {
      frame.problem = info_.name + ": frame " + std::to_string(frame.number) +
                      " has another size than the first";
    } else {
      frame.image = preparation_.Left(image);
      if (!color.empty()) frame.color = preparation_.Left(color);
    }
    return frame;
  }

  bool Seek(int frames) override {
    if (frames < next_ && !SeekBack(frames)) return false;
    while (next_ < frames && GrabNext()) Advance();
    return next_ == frames;
  }

 private:
  // Grabs frame next_ unless it is already grabbed, and records its time. Returns false at the end.
  bool GrabNext() {
    if (!grabbed_ && !stream_->Grab()) {
      WarnIfShort();
      return false;
    }
    grabbed_ = true;
    if (next_ == static_cast<int>(times_.size())) {
      stream_times_.push_back(stream_->Time());
      times_.push_back(TimeOfNewest());
    }
    return true;
  }

  // Time of the frame grabbed last, seconds. Normally it is the stream's time. An isolated time
  // that does not increase is replaced by the mean of its neighbors' times, so that later frames
  // keep theirs. If the clock stands still (a stream without usable times reports 0) or restarts,
  // time advances by the frame rate.
  double TimeOfNewest() {
    const double told = stream_times_.back() + offset_;
    if (times_.empty()) return told;
    if (told > times_.back() + kLeastStep / info_.camera.fps) {
      expected_ = told + 1 / info_.camera.fps;
      repeated_ = 0;
      return told;
    }
    const double next = times_.back() + 1 / info_.camera.fps;
    if (!expected_) return next;  // the clock has never advanced
    if (++repeated_ <= kMostRepeated) return (times_.back() + *expected_) / 2;
    offset_ += next - told;
    return next;
  }

  void Advance() {
    ++next_;
    grabbed_ = false;
  }

  // Seeks to a frame that was already played. FFmpeg seeks by time and OpenCV assumes a constant
  // frame rate, so the frame reached is identified by its time from the first pass. Tries targets
  // 2, 16 and 64 frames earlier, then reopens the stream.
  bool SeekBack(int frames) {
    for (const int margin : {2, 16, 64}) {
      if (margin >= frames) break;
      if (!stream_->SeekNear(stream_times_[static_cast<size_t>(frames - margin)]) ||
          !stream_->Grab())
        continue;
      const auto found =
          std::find_if(stream_times_.begin(), stream_times_.end(),
                       [this](double time) { return std::abs(time - stream_->Time()) < 1e-6; });
      const auto index = static_cast<int>(found - stream_times_.begin());
      if (index > frames) continue;
      next_ = index;
      grabbed_ = true;
      return true;
    }
    stream_ = OpenVideo(path_);
    next_ = 0;
    grabbed_ = false;
    return true;
  }

  void WarnIfShort() {
    if (warned_ || next_ + 2 >= info_.frames) return;
    warned_ = true;
    LogWarning(info_.name + " ends after " + std::to_string(next_) + " of " +
               std::to_string(info_.frames) + " frames: the file may be truncated");
  }

  SourceInfo info_;
  std::string path_;
  std::unique_ptr<MediaStream> stream_;
  ImagePreparation preparation_;
  cv::Size raw_size_;
  bool color_;  // read the frames' colors as well
  // Times of the frames played so far, seconds: the stream's own, and those returned.
  std::vector<double> stream_times_, times_;
  double offset_ = 0;  // seconds, from the stream's clock to the returned times
  // Expected time of the next frame by the frame rate, once the clock advanced.
  std::optional<double> expected_;
  int repeated_ = 0;     // consecutive frames whose time did not increase
  int next_ = 0;         // number of the frame the next call returns
  bool grabbed_ = true;  // frame next_ is already grabbed
  bool warned_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> OpenVideoSource(const std::string& path,
                                             const SourceOptions& options) {
  if (options.sensor.value_or(Sensor::kMono) != Sensor::kMono)
    ThrowUsage(path + " has one camera: use --sensor mono");
  std::unique_ptr<MediaStream> stream = OpenVideo(path);
  const cv::Mat first = stream->Grab() ? stream->Gray() : cv::Mat();
  if (first.empty()) ThrowInput(path + ": no image can be read");
  const std::filesystem::path file(path);
  SourceInfo info;
  info.name = file.stem().string();
  info.kind = "video";
  std::optional<Calibration> beside;
  if (!options.camera_file)
    beside = CalibrationBeside(file.parent_path().string(), first.size(), options);
  auto [calibration, guessed, lens_told] =
      ChooseCalibration(beside, first.size(), options, stream->FocalLength35());
  const double fps = stream->FramesPerSecond();
  // The camera file's rate is used only when the stream states none, so that times do not depend on
  // the calibration.
  if (std::isfinite(fps) && fps > 0) calibration.fps = fps;
  ImagePreparation preparation(calibration, Sensor::kMono);
  info.camera = preparation.camera();
  info.camera_guessed = guessed;
  info.lens_told = lens_told;
  info.told = calibration.told;
  const int frames = stream->FrameCount();
  info.frames = frames > 0 ? frames : -1;
  return std::make_unique<VideoSource>(std::move(info), path, std::move(stream),
                                       std::move(preparation), first.size(), options.color);
}

}  // namespace alidade
