#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/trajectory.h"
#include "alidade/io/wrappers.h"

namespace alidade {
namespace {

class RepeatedSource : public FrameSource {
 public:
  RepeatedSource(std::unique_ptr<FrameSource> source, int times)
      : source_(std::move(source)), info_(source_->Info()), legs_(2 * times) {
    if (info_.frames > 0) info_.frames = 1 + legs_ * (info_.frames - 1);
    if (info_.imu) {
      LogWarning(
          "the inertial readings are not used with --repeat: played backward they contradict "
          "their own bias");
    }
    info_.imu.reset();
  }

  const SourceInfo& Info() const override { return info_; }

  std::optional<SourceFrame> Next() override {
    if (leg_ == 0) {  // the first pass forwards: frames as recorded
      if (auto frame = source_->Next()) {
        if (played_ == 0) first_number_ = frame->number;
        ++played_;
        time_ = recorded_time_ = frame->time;
        frame->imu.clear();
        return frame;
      }
      length_ = played_;
      leg_ = 1;
      at_ = length_ - 1;
    }
    return length_ > 1 ? Step() : std::nullopt;
  }

 private:
  bool forwards() const { return leg_ % 2 == 0; }

  std::optional<SourceFrame> Step() {
    if (at_ == (forwards() ? length_ - 1 : 0)) ++leg_;
    if (leg_ == legs_) return std::nullopt;
    at_ += forwards() ? 1 : -1;
    std::optional<SourceFrame> frame = Get(at_);
    if (!frame)
      ThrowInput("frame " + std::to_string(first_number_ + at_) +
                 " could be read before, but not again");
    time_ += std::abs(frame->time - recorded_time_);
    recorded_time_ = frame->time;
    frame->time = time_;
    frame->stamp = FormatTime(time_);
    frame->number = first_number_ + played_++;
    frame->imu.clear();
    return frame;
  }

  // Reads blocks of frames forwards even when playing backwards, because seeking in a video is
  // slow.
  std::optional<SourceFrame> Get(int index) {
    constexpr int kBlock = 32;
    if (index < block_start_ || index >= block_start_ + static_cast<int>(block_.size())) {
      const int start = forwards() ? index : std::max(0, index - kBlock + 1);
      block_.clear();
      block_start_ = start;
      if (!forwards() || index != next_in_source_) {
        if (!source_->Seek(start))
          ThrowUsage("--repeat needs a recording that can be played backward");
      }
      const int count = forwards() ? 1 : index - start + 1;
      for (int i = 0; i < count; ++i) {
        auto frame = source_->Next();
        if (!frame) return std::nullopt;
        block_.push_back(std::move(*frame));
      }
      next_in_source_ = start + count;
    }
    return block_[static_cast<size_t>(index - block_start_)];
  }

  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  int legs_;        // passes in total, forwards and backwards
  int leg_ = 0;     // current pass; even: forwards
  int length_ = 0;  // frames of the recording, known after the first pass
  int at_ = 0;      // index of the last returned frame
  int played_ = 0;  // frames returned so far
  int first_number_ = 0;
  // Time of the last returned frame as played and as recorded, seconds.
  double time_ = 0, recorded_time_ = 0;
  std::vector<SourceFrame> block_;
  int block_start_ = 0;
  int next_in_source_ = -1;
};

}  // namespace

std::unique_ptr<FrameSource> Repeat(std::unique_ptr<FrameSource> source, int times) {
  if (times < 0) ThrowUsage("--repeat must not be negative");
  if (times == 0) return source;
  // Frame numbers must fit into an int: 2 · times · frames. When a video does not state its length,
  // one day at 30 frames per second is assumed.
  constexpr int64_t kUnknown = 30 * 86400;
  const int64_t frames = source->Info().frames > 0 ? source->Info().frames : kUnknown;
  const int64_t most = (std::numeric_limits<int>::max() - 1) / (2 * frames);
  if (times > most)
    ThrowUsage("--repeat " + std::to_string(times) + " of this recording gives more frames than " +
               "can be counted: at most " + std::to_string(most));
  return std::make_unique<RepeatedSource>(std::move(source), times);
}

}  // namespace alidade
