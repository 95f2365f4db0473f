// Interface of libalidade_dnn.so, which reads an ONNX network and runs it on the CPU.
// open_detector.cc loads it on first use; no target links it. The program and the module are built
// together, so the interface may use C++ types; only the function name is C. No exception leaves
// the module.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace alidade {

inline constexpr int kAllOutputs = -1;

// Use from one thread at a time. Runs on as many threads as OpenCV is set to (cv::setNumThreads).
class Network {
 public:
  virtual ~Network() = default;
  // `input`: 1 × 3 × height × width floats. Sets `outputs` to output number `which`, or to all
  // outputs for kAllOutputs; they are valid until the next call. Returns "" on success, else the
  // reason.
  virtual std::string Run(const cv::Mat& input, int which, std::vector<cv::Mat>* outputs) = 0;
};

inline constexpr char kDnnModuleFile[] = "libalidade_dnn.so";

// Returns null and sets `problem` when the bytes are not a readable network.
using NetworkOpenFunction = Network*(const char* bytes, size_t size, std::string* problem);

}  // namespace alidade
