#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/io/wrappers.h"

namespace alidade {
namespace {

class ImuSource : public FrameSource {
 public:
  ImuSource(std::unique_ptr<FrameSource> source, ImuRecording imu, const std::string& told)
      : source_(std::move(source)), info_(source_->Info()), samples_(std::move(imu.samples)) {
    info_.imu = imu.model;
    if (!told.empty()) info_.told += (info_.told.empty() ? "" : "\n") + told;
  }

  const SourceInfo& Info() const override { return info_; }

  bool Seek(int frames) override {
    if (!source_->Seek(frames)) return false;
    before_.reset();
    return true;
  }

  std::optional<SourceFrame> Next() override {
    std::optional<SourceFrame> frame = source_->Next();
    if (!frame || !std::isfinite(frame->time)) return frame;
    const double time = frame->time + info_.imu->time_offset;
    if (!std::exchange(checked_, true)) CheckClock(time);
    // At the start, and where the clock was set back.
    if (!before_ || time < *before_) next_ = FirstAfter(time - kImuAround);
    before_ = time;
    const size_t end = std::max(next_, FirstAfter(time + kImuAround));
    const auto at = [&](size_t i) { return samples_.begin() + static_cast<std::ptrdiff_t>(i); };
    frame->imu.assign(at(next_), at(end));
    next_ = end;
    return frame;
  }

 private:
  void CheckClock(double time) const {
    constexpr double kFarOff = 60;  // seconds: other clocks are off by hours, or by years
    const double begin = samples_.front().time, end = samples_.back().time;
    if (time > begin - kFarOff && time < end + kFarOff) return;
    char text[200];
    PrintTo(text, sizeof(text),
            "the inertial readings (%.3f to %.3f s) are of another time than the images (from %.3f "
            "s): they are not used",
            begin, end, time);
    LogWarning(text);
  }

  size_t FirstAfter(double time) const {
    const auto after = [](double t, const ImuSample& sample) { return t < sample.time; };
    return static_cast<size_t>(std::upper_bound(samples_.begin(), samples_.end(), time, after) -
                               samples_.begin());
  }

  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  std::vector<ImuSample> samples_;
  bool checked_ = false;
  size_t next_ = 0;               // the first one that was not given yet
  std::optional<double> before_;  // time of the last frame, on the clock of the samples
};

}  // namespace

std::unique_ptr<FrameSource> WithImu(std::unique_ptr<FrameSource> source, ImuRecording imu,
                                     const std::string& told) {
  if (imu.samples.empty()) return source;
  return std::make_unique<ImuSource>(std::move(source), std::move(imu), told);
}

}  // namespace alidade
