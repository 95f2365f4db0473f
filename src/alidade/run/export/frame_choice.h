// Which frames of a recording are exported as images.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace alidade {

struct FrameChoice {
  enum class Kind {
    kKeyframes,
    kEvery,     // frames whose number in the recording is a multiple of `every`
    kSharpest,  // the sharpest frame with a pose of each 1 / `rate` seconds
  } kind = Kind::kKeyframes;
  int every = 1;
  double rate = 1;  // 1/s
};

// "keyframes", "every:N" or "sharpest:RATE". Throws Error (usage) for other words.
FrameChoice FrameChoiceNamed(const std::string& word);

// Variance of the Laplacian (Pech-Pacheco et al. 2000), gray levels²: larger for sharper images of
// the same scene. `gray`: CV_8UC1.
double SharpnessOf(const cv::Mat& gray);

}  // namespace alidade
