#include "alidade/io/frame_finder.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alidade/base/error.h"

namespace alidade {
namespace {

// Seconds; the resolution of a double that holds seconds since 1970.
constexpr double kSameTime = 1e-6;

}  // namespace

FrameFinder::FrameFinder(FrameSource& source) : source_(source), frames_(source.Info().frames) {
  if (frames_ < 0 || !source_.Seek(0))
    ThrowInput(source_.Info().name + " can only be played from the start");
}

const SourceFrame& FrameFinder::Read(int number) {
  if (number == last_number_) return last_;
  source_.Seek(number);
  std::optional<SourceFrame> frame = source_.Next();
  if (!frame) ThrowInput(source_.Info().name + " ends before frame " + std::to_string(number));
  last_ = *std::move(frame);
  last_number_ = number;
  known_[number] = {last_.time, last_.problem.empty()};
  return last_;
}

// Index of a frame strictly between `low` and `high`, by linear interpolation of time or, with
// `halve`, in the middle. `low` and `high` are known frames on either side of `time`; -1 and the
// number of frames mean none is known there.
int FrameFinder::Guess(double time, int low, int high, bool halve) const {
  const double fps = source_.Info().camera.fps;
  double guess = 0;
  if (low >= 0 && high < frames_) {
    const double t0 = known_.at(low).time, t1 = known_.at(high).time;
    guess = halve || !(t1 > t0) ? 0.5 * (low + high) : low + (time - t0) / (t1 - t0) * (high - low);
  } else if (low >= 0) {
    guess = low + (time - known_.at(low).time) * fps;
  } else if (high < frames_) {
    guess = high - (known_.at(high).time - time) * fps;
  }
  return static_cast<int>(std::lround(std::clamp(guess, low + 1.0, high - 1.0)));
}

std::optional<SourceFrame> FrameFinder::Nearest(double time, double max_dt) {
  for (int step = 1; frames_ > 0; ++step) {
    const auto after = std::find_if(known_.begin(), known_.end(),
                                    [time](const auto& it) { return it.second.time >= time; });
    const int high = after == known_.end() ? frames_ : after->first;
    const int low = after == known_.begin() ? -1 : std::prev(after)->first;
    const auto distance = [&](int number) {
      return number < 0 || number == frames_ ? HUGE_VAL : std::abs(known_.at(number).time - time);
    };
    const int nearest = distance(low) <= distance(high) ? low : high;
    const bool found = distance(nearest) < kSameTime && known_.at(nearest).good;
    if (found || high - low == 1) {
      if (distance(nearest) > max_dt) return std::nullopt;
      return Read(nearest);
    }
    // Bisection every third step ends the search when the frame rate is uneven.
    Read(Guess(time, low, high, step % 3 == 0));
  }
  return std::nullopt;
}

}  // namespace alidade
