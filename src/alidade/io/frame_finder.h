// Finds the frames of a recording taken at given times without reading all of them.
#pragma once

#include <map>
#include <optional>

#include "alidade/io/frame_source.h"

namespace alidade {

class FrameFinder {
 public:
  // `source` must outlive this object, and its frames must be in order of time. Throws Error
  // (input) when `source` cannot seek or its length is unknown.
  explicit FrameFinder(FrameSource& source);

  // Returns the frame nearest to `time`, at most `max_dt` seconds away, or nullopt. The frame may
  // have a `problem`. The search starts at an index computed from the frame rate and the frames
  // read so far; at a constant frame rate the first frame read is the result.
  std::optional<SourceFrame> Nearest(double time, double max_dt);

 private:
  struct Known {
    double time;  // seconds
    bool good;    // read without a problem
  };
  const SourceFrame& Read(int number);
  int Guess(double time, int low, int high, bool halve) const;

  FrameSource& source_;
  int frames_;
  std::map<int, Known> known_;  // frames read so far, by index in the source
  SourceFrame last_;            // the last frame read
  int last_number_ = -1;
};

}  // namespace alidade
