// The part of a detector that runs in a web page besides the network itself (onnxruntime):
// preparing the input and decoding the outputs. A separate module, loaded only when moving objects
// are excluded. Called by web/phone/src/detector_module.ts. No exception leaves it;
// alidade_detector_error() returns the reason of a failure.
#include <emscripten.h>

#include <exception>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/detect/yolo_model.h"

namespace {

// The current model with its input and outputs.
struct Opened {
  explicit Opened(std::string_view bytes) : model(bytes) {}
  alidade::YoloModel model;
  std::vector<std::vector<int>> shapes;
  std::vector<std::vector<float>> outputs;
  cv::Mat input;
  std::vector<float> found;
  std::string names;
};

std::unique_ptr<Opened> opened;
std::string last_error;

template <typename Call>
int Tried(Call&& call) {
  try {
    return call();
  } catch (const std::exception& error) {
    last_error = error.what();
  } catch (...) {
    last_error = "unknown error";
  }
  return -1;
}

std::vector<alidade::NetworkOutput> Outputs() {
  std::vector<alidade::NetworkOutput> views;
  for (size_t i = 0; i < opened->outputs.size(); ++i)
    views.push_back({opened->shapes[i], opened->outputs[i]});
  return views;
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* alidade_detector_error() { return last_error.c_str(); }

// Parses an ONNX file's bytes, which need not outlive the call. Negative: not a detector.
EMSCRIPTEN_KEEPALIVE int alidade_detector_open(const char* bytes, int size) {
  return Tried([&] {
    opened.reset();
    opened = std::make_unique<Opened>(std::string_view(bytes, static_cast<size_t>(size)));
    opened->input = opened->model.TrialInput();
    return 0;
  });
}

// The network's input, 1 x 3 x height x width floats; after alidade_detector_open() that of the
// trial run.
EMSCRIPTEN_KEEPALIVE const float* alidade_detector_input() { return opened->input.ptr<float>(); }
EMSCRIPTEN_KEEPALIVE int alidade_detector_width() { return opened->model.input().width; }
EMSCRIPTEN_KEEPALIVE int alidade_detector_height() { return opened->model.input().height; }

// Returns the buffer for output number `index` with the given shape. Call in order of `index`.
EMSCRIPTEN_KEEPALIVE float* alidade_detector_output(int index, const int* shape, int sides) {
  size_t total = 1;
  for (int i = 0; i < sides; ++i) total *= static_cast<size_t>(shape[i]);
  opened->shapes.resize(static_cast<size_t>(index));
  opened->outputs.resize(static_cast<size_t>(index));
  opened->shapes.emplace_back(shape, shape + sides);
  return opened->outputs.emplace_back(total).data();
}

// Detects the network's family from the outputs of the trial run. Returns the index of the output
// that alidade_detector_read() expects; negative: unknown family.
EMSCRIPTEN_KEEPALIVE int alidade_detector_recognise() {
  return Tried([&] {
    opened->model.Recognise(Outputs());
    opened->names.clear();
    for (const std::string& name : opened->model.class_names()) opened->names += name + '\n';
    return opened->model.output();
  });
}

// Class names, one per line.
EMSCRIPTEN_KEEPALIVE const char* alidade_detector_names() { return opened->names.c_str(); }

// `pixels`: red green blue alpha.
EMSCRIPTEN_KEEPALIVE int alidade_detector_prepare(const uint8_t* pixels, int width, int height) {
  return Tried([&] {
    cv::Mat image;
    cv::cvtColor(cv::Mat(height, width, CV_8UC4, const_cast<uint8_t*>(pixels)), image,
                 cv::COLOR_RGBA2BGR);
    opened->input = opened->model.Prepare(image);
    return 0;
  });
}

// Decodes output 0 for an image of this size. Each detection has 6 floats at `*at`: class, score,
// x, y, width, height (pixels of the image). Returns the number of detections.
EMSCRIPTEN_KEEPALIVE int alidade_detector_read(int width, int height, const float** at) {
  return Tried([&] {
    opened->found.clear();
    for (const alidade::Detection& d : opened->model.Read(Outputs().at(0), {width, height})) {
      for (const float value :
           {static_cast<float>(d.class_id), d.score, d.box.x, d.box.y, d.box.width, d.box.height})
        opened->found.push_back(value);
    }
    *at = opened->found.data();
    return static_cast<int>(opened->found.size() / 6);
  });
}

}  // extern "C"
