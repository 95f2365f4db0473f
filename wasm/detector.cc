// A detector's file in a page, but for running its network, which onnxruntime does: what goes in,
// and what its outputs mean. A module of its own, loaded only where people are left out. Called by
// web/phone/src/detector_module.ts; no exception leaves it: alidade_detector_error() says why.
#include <emscripten.h>

#include <exception>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/detect/yolo_model.h"

namespace {

// The file that was opened last, and what was told of it.
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
    last_error = "something unknown went wrong";
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

// Of the file's bytes, which may go afterwards. Below 0: it is no detector.
EMSCRIPTEN_KEEPALIVE int alidade_detector_open(const char* bytes, int size) {
  return Tried([&] {
    opened.reset();
    opened = std::make_unique<Opened>(std::string_view(bytes, static_cast<size_t>(size)));
    opened->input = opened->model.TrialInput();
    return 0;
  });
}

// The network's input, 1 x 3 x height x width floats: a trial picture after open.
EMSCRIPTEN_KEEPALIVE const float* alidade_detector_input() { return opened->input.ptr<float>(); }
EMSCRIPTEN_KEEPALIVE int alidade_detector_width() { return opened->model.input().width; }
EMSCRIPTEN_KEEPALIVE int alidade_detector_height() { return opened->model.input().height; }

// Room for the network's output numbered `index`, of that shape; they are given in order.
EMSCRIPTEN_KEEPALIVE float* alidade_detector_output(int index, const int* shape, int sides) {
  size_t total = 1;
  for (int i = 0; i < sides; ++i) total *= static_cast<size_t>(shape[i]);
  opened->shapes.resize(static_cast<size_t>(index));
  opened->outputs.resize(static_cast<size_t>(index));
  opened->shapes.emplace_back(shape, shape + sides);
  return opened->outputs.emplace_back(total).data();
}

// By the outputs for the trial picture. Returns the number of the output that alidade_detector_read
// takes; below 0: no detector that is known.
EMSCRIPTEN_KEEPALIVE int alidade_detector_recognise() {
  return Tried([&] {
    opened->model.Recognise(Outputs());
    opened->names.clear();
    for (const std::string& name : opened->model.class_names()) opened->names += name + '\n';
    return opened->model.output();
  });
}

// Names of the classes, a line each.
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

// Of the output given last (as number 0), for a picture of that size: class, score, x, y, width,
// height (pixels of the picture) of each thing. Returns how many, at `*at`.
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
