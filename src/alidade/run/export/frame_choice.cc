#include "alidade/run/export/frame_choice.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/io/text.h"

namespace alidade {

FrameChoice FrameChoiceNamed(const std::string& word) {
  FrameChoice choice;
  if (word == "keyframes") return choice;
  const size_t colon = word.find(':');
  const std::string name = word.substr(0, colon);
  const double number =  // 0: none, which is out of range
      colon == std::string::npos ? 0 : ParseNumber(word.substr(colon + 1)).value_or(0);
  if (name == "every" && number >= 1 && number <= 1e6 && number == std::floor(number)) {
    choice.kind = FrameChoice::Kind::kEvery;
    choice.every = static_cast<int>(number);
    return choice;
  }
  if (name == "sharpest" && number >= 1e-3 && number <= 1e3) {
    choice.kind = FrameChoice::Kind::kSharpest;
    choice.rate = number;
    return choice;
  }
  ThrowUsage(
      "--images cannot be '" + word +
      "': it is keyframes, every:N (each N-th frame, from 1) or sharpest:RATE (images per second, "
      "0.001 to 1000)");
}

double SharpnessOf(const cv::Mat& gray) {
  cv::Mat edges;
  cv::Laplacian(gray, edges, CV_16S);
  cv::Scalar mean, deviation;
  cv::meanStdDev(edges, mean, deviation);
  return deviation[0] * deviation[0];
}

}  // namespace alidade
