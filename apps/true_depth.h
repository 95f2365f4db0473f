// The true depth of a sequence's frames: exact where it was rendered, a depth sensor's elsewhere.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "alidade/io/frame_finder.h"
#include "alidade/io/frame_source.h"

namespace alidade {

struct TrueDepth {
  cv::Mat image;  // CV_8U
  cv::Mat depth;  // CV_32F, metres, 0 = unknown; empty: this frame has none
};

class TrueDepthSource {
 public:
  // `sequence` is what `run` can open; a recording that `alidade synth` wrote is rendered anew,
  // since the depth images in it have a sensor's faults. `sensor` (of the run): says whether images
  // were rectified. Throws Error: kInput when there is no depth.
  TrueDepthSource(const std::string& sequence, std::optional<Sensor> sensor,
                  const std::optional<std::string>& camera_file);

  bool rendered() const { return rendered_; }
  // Of the frame nearest to `time`, at most `max_dt` away (seconds); nullopt: there is none.
  std::optional<TrueDepth> At(double time, double max_dt);

 private:
  bool rendered_;
  double time_offset_ = 0;  // seconds from the times of the recording to those of the source
  std::unique_ptr<FrameSource> source_;
  std::unique_ptr<FrameFinder> finder_;
};

}  // namespace alidade
