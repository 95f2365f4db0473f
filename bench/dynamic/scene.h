// A recording with people in it, and what is known of them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/evaluation/ate.h"
#include "alidade/io/frame_source.h"
#include "alidade/io/trajectory.h"

namespace alidade::bench {

struct DynamicScene {
  std::string name;  // short
  std::string source;
  SourceInfo info;
  std::vector<SourceFrame> frames;  // that could be read
  Trajectory truth;                 // of the camera
  // One for each frame, as far as the recording tells; none at all: it doesn't.
  std::vector<cv::Mat> masks;                 // CV_8U, 255 = people; empty where unknown
  std::vector<std::vector<cv::Rect>> people;  // boxes around them, pixels

  bool has_masks() const { return !masks.empty(); }
  TimeSpan span() const { return {frames.front().time, frames.back().time}; }
};

// `source`: a TUM folder with groundtruth.txt, or `synth:…`; frames `first` to `last` (-1: the
// end). Masks are those of its mask.txt, boxes of people.txt or around each piece of mask. Throws
// Error (input) when there are fewer than 2 frames or no truth.
// `camera_file`: calibration instead of the recording's own, of recorded ones.
DynamicScene LoadDynamicScene(const std::string& source, int first, int last, bool color,
                              const std::optional<std::string>& camera_file = {});

}  // namespace alidade::bench
