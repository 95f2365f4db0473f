// What libalidade_dnn.so offers: a network read from an ONNX file, run on the processor. It is
// loaded by open_detector.cc and linked by nobody. Both sides are built together: the interface may
// hold C++ types, only its one name is C. No exception leaves the module.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace alidade {

inline constexpr int kAllOutputs = -1;

// One thread at a time; uses as many as OpenCV is told to (cv::setNumThreads).
class Network {
 public:
  virtual ~Network() = default;
  // `input`: 1 × 3 × height × width floats. Replaces `outputs` by the one numbered `which`, or by
  // all of them; they are good until the next call. Returns why there are none, "" when all is
  // well.
  virtual std::string Run(const cv::Mat& input, int which, std::vector<cv::Mat>* outputs) = 0;
};

inline constexpr char kDnnModuleFile[] = "libalidade_dnn.so";

// Null, with the reason in `problem`, when the bytes are no network that can be read.
using NetworkOpenFunction = Network*(const char* bytes, size_t size, std::string* problem);

}  // namespace alidade
