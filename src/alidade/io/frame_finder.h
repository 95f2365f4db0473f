// The frames of a recording that were taken at given times, without reading all of them.
#pragma once

#include <map>
#include <optional>

#include "alidade/io/frame_source.h"

namespace alidade {

class FrameFinder {
 public:
  // `source` must outlive this; its frames come in the order of time. Throws Error (input) when it
  // cannot seek or does not know its length.
  explicit FrameFinder(FrameSource& source);

  // The frame nearest to `time`, at most `max_dt` seconds away; nullopt: there is none. May be one
  // with a `problem`. Guesses where it lies from the frame rate and what it has seen: at an even
  // rate the frame asked for is the first one read.
  std::optional<SourceFrame> Nearest(double time, double max_dt);

 private:
  struct Known {
    double time;  // seconds
    bool good;    // without a problem
  };
  const SourceFrame& Read(int number);
  int Guess(double time, int low, int high, bool halve) const;

  FrameSource& source_;
  int frames_;
  std::map<int, Known> known_;  // frames read so far, by their place in the source
  SourceFrame last_;            // the one read last
  int last_number_ = -1;
};

}  // namespace alidade
