// The frames of a recording at given times, without reading all others.
#pragma once

#include <memory>
#include <vector>

#include "alidade/io/frame_source.h"

namespace alidade {

// Recordings of image files and rendered ones are searched by time, since a frame there costs the
// same wherever it is; of others (videos, bags) every frame is read.
class TimedFrames : public FrameSource {
 public:
  // `times`: seconds, in order; frames within a microsecond of one are returned.
  TimedFrames(std::unique_ptr<FrameSource> source, std::vector<double> times);

  const SourceInfo& Info() const override { return source_->Info(); }
  std::optional<SourceFrame> Next() override;

 private:
  std::optional<SourceFrame> Scan();
  std::optional<SourceFrame> Find(double time);

  std::unique_ptr<FrameSource> source_;
  std::vector<double> times_;
  size_t next_ = 0;
  bool jumps_;
  double rate_;                                   // frames per second, by the last two frames
  std::optional<std::pair<int, double>> before_;  // number and time of the last frame returned
};

}  // namespace alidade
