// True depth of the frames of a sequence: exact if it was rendered, else that of a depth sensor.
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
  cv::Mat depth;  // CV_32F, meters, 0 = unknown; empty: no depth
};

class TrueDepthSource {
 public:
  // `sequence`: a source of `run`. A recording of `alidade synth` is rendered again, since its
  // depth images have the errors of a sensor. `sensor` (of the run): whether images were rectified.
  // Throws Error (input) if there is no depth.
  TrueDepthSource(const std::string& sequence, std::optional<Sensor> sensor,
                  const std::optional<std::string>& camera_file);

  bool rendered() const { return rendered_; }
  // Depth of the frame nearest to `time`, at most `max_dt` seconds away; nullopt: there is none.
  std::optional<TrueDepth> At(double time, double max_dt);

 private:
  bool rendered_;
  double time_offset_ = 0;  // offset from the recording's times to those of the source, seconds
  std::unique_ptr<FrameSource> source_;
  std::unique_ptr<FrameFinder> finder_;
};

}  // namespace alidade
