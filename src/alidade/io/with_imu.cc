#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "alidade/io/wrappers.h"

namespace alidade {
namespace {

class ImuSource : public FrameSource {
 public:
  ImuSource(std::unique_ptr<FrameSource> source, ImuRecording imu)
      : source_(std::move(source)), info_(source_->Info()), samples_(std::move(imu.samples)) {
    info_.imu = imu.model;
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const ImuSample& a, const ImuSample& b) { return a.time < b.time; });
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
  size_t FirstAfter(double time) const {
    const auto after = [](double t, const ImuSample& sample) { return t < sample.time; };
    return static_cast<size_t>(std::upper_bound(samples_.begin(), samples_.end(), time, after) -
                               samples_.begin());
  }

  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  std::vector<ImuSample> samples_;
  size_t next_ = 0;               // the first one that was not given yet
  std::optional<double> before_;  // time of the last frame, on the clock of the samples
};

}  // namespace

std::unique_ptr<FrameSource> WithImu(std::unique_ptr<FrameSource> source, ImuRecording imu) {
  return std::make_unique<ImuSource>(std::move(source), std::move(imu));
}

}  // namespace alidade
