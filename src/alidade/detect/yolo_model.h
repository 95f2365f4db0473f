// The parts of a detector other than running its network: preparing the input and decoding the
// outputs. The network runs in OpenCV's dnn (detect/onnx) or, in a web page, in onnxruntime
// (wasm/).
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/detect/detector.h"
#include "alidade/detect/model_file.h"
#include "alidade/detect/network_input.h"
#include "alidade/detect/settings.h"
#include "alidade/detect/yolo_output.h"

namespace alidade {

// docs/guides/detectors.md lists supported files and explains the choice of color order and size.
class YoloModel {
 public:
  // Parses the bytes of an ONNX file, which need not outlive this object. Throws Error (input) when
  // they are not a network with one image as input.
  explicit YoloModel(std::string_view bytes, const DetectorSettings& settings = {});

  cv::Size input() const { return input_; }  // size of the network's input, pixels
  bool leaves_size_open() const { return leaves_size_open_; }
  // Input for a trial run: a gray image. Recognise() detects the network's family from the outputs
  // of this run. It throws Error (input) for an unknown family.
  cv::Mat TrialInput() const;
  void Recognise(std::span<const NetworkOutput> outputs);

  // The following require Recognise() first.
  const std::vector<std::string>& class_names() const { return class_names_; }
  int output() const { return layout_.output; }  // index of the output that Read() expects
  // Converts an image (CV_8UC3 blue green red, or CV_8UC1, any size) to the network's input.
  cv::Mat Prepare(const cv::Mat& image) const;
  // Decodes the output to detections as in Detector::Detect(); `image`: size of the image. Throws
  // Error (input) for an invalid output.
  std::vector<Detection> Read(const NetworkOutput& output, cv::Size image) const;

 private:
  OnnxModel model_;
  DetectorSettings settings_;
  cv::Size input_;
  bool leaves_size_open_ = false;
  YoloLayout layout_;
  InputConvention convention_;
  std::vector<std::string> class_names_;
};

}  // namespace alidade
