#include "alidade/run/surface/timed_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace alidade {
namespace {

constexpr double kSameInstant = 1e-6;  // seconds
constexpr int kMostReads = 40;         // of one search: bisection of a million frames takes 20

bool IsOfFiles(const std::string& kind) {
  constexpr std::array<std::string_view, 5> kKinds = {"tum", "euroc", "kitti", "images", "synth"};
  return std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end();
}

}  // namespace

TimedFrames::TimedFrames(std::unique_ptr<FrameSource> source, std::vector<double> times)
    : source_(std::move(source)),
      times_(std::move(times)),
      jumps_(IsOfFiles(source_->Info().kind) && source_->Info().frames > 0),
      rate_(std::max(1e-3, source_->Info().camera.fps)) {}

std::optional<SourceFrame> TimedFrames::Next() {
  if (!jumps_) return Scan();
  while (next_ < times_.size()) {
    if (auto frame = Find(times_[next_++])) return frame;
  }
  return std::nullopt;
}

std::optional<SourceFrame> TimedFrames::Scan() {
  while (auto frame = source_->Next()) {
    const auto at = std::lower_bound(times_.begin(), times_.end(), frame->time - kSameInstant);
    if (at != times_.end() && *at <= frame->time + kSameInstant) return frame;
  }
  return std::nullopt;
}

// Guesses the number by the rate, which finds evenly taken frames at once, and bisects when the
// guess leaves the bracket.
std::optional<SourceFrame> TimedFrames::Find(double time) {
  int low = before_ ? before_->first : -1, high = source_->Info().frames;
  double guess = before_ ? before_->first + (time - before_->second) * rate_ : 0;
  for (int read = 0; read < kMostReads && high - low > 1; ++read) {
    const bool inside = guess > low && guess < high;
    const int number = std::clamp(
        inside ? static_cast<int>(std::lround(guess)) : low + (high - low) / 2, low + 1, high - 1);
    if (!source_->Seek(number)) return std::nullopt;
    auto frame = source_->Next();
    if (!frame) return std::nullopt;
    const double late = frame->time - time;
    if (std::abs(late) <= kSameInstant) {
      if (before_ && number > before_->first && frame->time > before_->second)
        rate_ = (number - before_->first) / (frame->time - before_->second);
      before_ = std::pair(number, frame->time);
      return frame;
    }
    (late < 0 ? low : high) = number;
    guess = number - std::copysign(std::max(1.0, std::abs(late * rate_)), late);
  }
  return std::nullopt;
}

}  // namespace alidade
