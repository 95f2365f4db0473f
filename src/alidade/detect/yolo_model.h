// A detector's file: what goes into its network and what its outputs mean. Everything but running
// it, which OpenCV's dnn does in the program (detect/onnx) and onnxruntime in a page (wasm/).
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

// Which files work, and how colours and sizes are chosen: docs/guides/detectors.md.
class YoloModel {
 public:
  // Of an ONNX file's bytes, which may go afterwards. Throws Error (input) when they are no network
  // that takes one picture.
  explicit YoloModel(std::string_view bytes, const DetectorSettings& settings = {});

  cv::Size input() const { return input_; }  // of the network, pixels
  bool leaves_size_open() const { return leaves_size_open_; }
  // A grey picture: the outputs for it tell which family the network is of, and Recognise() takes
  // them. Throws Error (input) when that is none that is known.
  cv::Mat TrialInput() const;
  void Recognise(std::span<const NetworkOutput> outputs);

  // After Recognise().
  const std::vector<std::string>& class_names() const { return class_names_; }
  int output() const { return layout_.output; }  // the one that Read() takes
  // What the network is given for a picture (CV_8UC3 blue green red, or CV_8UC1, of any size).
  cv::Mat Prepare(const cv::Mat& image) const;
  // What was found in it: as Detector::Detect. Throws Error (input) on an output that cannot be.
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
