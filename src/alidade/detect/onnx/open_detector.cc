#include "alidade/detect/onnx/open_detector.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/detect/class_names.h"
#include "alidade/detect/letterbox.h"
#include "alidade/detect/network_input.h"
#include "alidade/detect/onnx/model_file.h"
#include "alidade/detect/onnx/network_module.h"
#include "alidade/detect/suppress.h"
#include "alidade/detect/yolo_output.h"

namespace alidade {
namespace {

constexpr int kStride = 32;          // of the coarsest cells: sides are multiples of it
constexpr int64_t kMostSide = 4096;  // pixels: beyond, it is a damaged file
constexpr size_t kMostNetworkBytes = size_t{1} << 30;  // the largest YOLO has 0.4 GB
constexpr int kOpenSize = 640;  // of both sides when the file leaves them open
constexpr char kAdvice[] =
    "; networks of the YOLOv5 and YOLOX families can be, others may need the layers of a newer "
    "OpenCV";
constexpr int kTrialGrey = 114;
constexpr int kFloat = 1, kHalf = 10;  // TensorProto.DataType

// Refused by size or start before there is memory for it: a sparse file takes none on the disk.
std::string ReadNetworkFile(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) ThrowInput("there is no such file");
  if (!std::filesystem::is_regular_file(status)) ThrowInput("is not a file");
  errno = 0;
  const auto fail = [] { ThrowInput(std::string("cannot be read: ") + std::strerror(errno)); };
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) fail();
  if (size > kMostNetworkBytes)
    ThrowInput("is longer than " + std::to_string(kMostNetworkBytes >> 20) +
               " MB: it cannot be a detector");
  std::string bytes(std::min<size_t>(size, 1), '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
  CheckOnnxStart(bytes);
  bytes.resize(size);
  if (!stream.read(bytes.data() + 1, static_cast<std::streamsize>(size - 1))) fail();
  return bytes;
}

cv::Size InputSize(const OnnxModel& model) {
  if (model.inputs.size() != 1)
    ThrowInput("has " + std::to_string(model.inputs.size()) +
               " inputs: a detector has one, the picture");
  const OnnxInput& input = model.inputs[0];
  const std::vector<int64_t>& shape = input.shape;
  if (input.element_type > 0 && input.element_type != kFloat && input.element_type != kHalf)
    ThrowInput("takes no floating point numbers as input: export it with a float32 input");
  if (shape.empty()) return {kOpenSize, kOpenSize};
  if (shape.size() != 4 || (shape[1] != 3 && shape[1] > 0))
    ThrowInput("takes no colour picture: its input should be 1 x 3 x height x width");
  if (shape[0] > 1) ThrowInput("takes several pictures at once: export it for a batch of 1");
  const auto side = [](int64_t length) -> int64_t { return length > 0 ? length : kOpenSize; };
  const int64_t width = side(shape[3]), height = side(shape[2]);
  if (width % kStride != 0 || height % kStride != 0 || width > kMostSide || height > kMostSide) {
    ThrowInput("has an input of " + std::to_string(width) + "x" + std::to_string(height) +
               ": sides must be multiples of 32, at most " + std::to_string(kMostSide));
  }
  return {static_cast<int>(width), static_cast<int>(height)};
}

bool LeavesSizeOpen(const OnnxModel& model) {
  const std::vector<int64_t>& shape = model.inputs[0].shape;
  return shape.size() != 4 || shape[2] < 1 || shape[3] < 1;
}

// What a network was trained with can't be read off its outputs; see docs/detectors.md.
InputConvention ConventionOf(const OnnxModel& model, const YoloLayout& layout) {
  const bool yolox = layout.family == YoloFamily::kAnchorFree && !layout.sure_of_objects;
  if (model.normalises_input) return {/*red_first=*/true, /*scale=*/1};
  if (yolox) return {/*red_first=*/false, /*scale=*/1};
  return {};
}

std::unique_ptr<Network> OpenNetwork(const std::string& bytes) {
  static const LoadedModule module = LoadModule(kDnnModuleFile, {"alidade_dnn_open"});
  if (module.symbols.empty())
    ThrowInput(std::string("needs ") + kDnnModuleFile + ": " + module.problem);
  const auto open = reinterpret_cast<NetworkOpenFunction*>(module.symbols[0]);
  std::string problem;
  std::unique_ptr<Network> network(open(bytes.data(), bytes.size(), &problem));
  if (!network)
    ThrowInput("is no network that OpenCV " CV_VERSION " can read: " + problem + kAdvice);
  return network;
}

NetworkOutput ViewOf(const cv::Mat& output) {
  if (output.type() != CV_32F || !output.isContinuous())
    ThrowInput("gives an output that is no array of floats");
  return {{output.size.p, output.size.p + output.dims}, {output.ptr<float>(), output.total()}};
}

class OnnxDetector : public Detector {
 public:
  OnnxDetector(const std::string& path, const DetectorSettings& settings)
      : path_(path), settings_(settings) {
    const std::string bytes = ReadNetworkFile(path);
    const OnnxModel model = ReadOnnxModel(bytes);
    if (model.external_weights)
      ThrowInput("keeps its weights in another file: export it as a single one");
    input_ = InputSize(model);
    network_ = OpenNetwork(bytes);
    Recognise(model);
    convention_ = ConventionOf(model, layout_);
    names_ = NamesFor(layout_.classes, ParseClassNames(model.class_names));
  }

  std::vector<Detection> Detect(const cv::Mat& image) override try {
    if (image.type() != CV_8UC3 && image.type() != CV_8UC1)
      ThrowInput("images have one or three channels of bytes");
    const Letterbox letterbox = FitInto(image.size(), input_);
    std::vector<Detection> found =
        SuppressOverlaps(Run(Apply(letterbox, image)), settings_.max_overlap);
    std::vector<Detection> detections;
    for (Detection& detection : found) {
      const std::optional<cv::Rect2f> box = ToImage(letterbox, detection.box);
      if (!box) continue;
      detection.box = *box;
      detections.push_back(detection);
    }
    return detections;
  } catch (const Error& error) {
    throw Error(error.kind(), path_ + ": " + error.what());
  }

  const std::vector<std::string>& ClassNames() const override { return names_; }

 private:
  void Recognise(const OnnxModel& model) {
    const cv::Mat grey(input_, CV_8UC3, cv::Scalar::all(kTrialGrey));
    std::vector<cv::Mat> outputs;
    const std::string problem = network_->Run(ToNetworkInput(grey, {}), kAllOutputs, &outputs);
    if (!problem.empty()) {
      ThrowInput("is no network that OpenCV " CV_VERSION " can run: " + problem +
                 (LeavesSizeOpen(model)
                      ? "; its input size is left open, export it with a fixed one"
                      : kAdvice));
    }
    std::vector<NetworkOutput> views;
    views.reserve(outputs.size());
    for (const cv::Mat& output : outputs) views.push_back(ViewOf(output));
    layout_ = RecogniseYolo(views, input_);
  }

  std::vector<Detection> Run(const cv::Mat& picture) {
    std::vector<cv::Mat> outputs;
    const std::string problem =
        network_->Run(ToNetworkInput(picture, convention_), layout_.output, &outputs);
    if (!problem.empty()) ThrowInput("the network failed: " + problem);
    std::vector<Detection> detections =
        DecodeYolo(layout_, ViewOf(outputs.at(0)), input_, settings_.min_score);
    for (const Detection& detection : detections) {
      if (detection.class_id >= static_cast<int>(names_.size()))
        ThrowInput("the network gives class " + std::to_string(detection.class_id) + " of " +
                   std::to_string(names_.size()));
    }
    return detections;
  }

  std::string path_;
  DetectorSettings settings_;
  cv::Size input_;
  std::unique_ptr<Network> network_;
  YoloLayout layout_;
  InputConvention convention_;
  std::vector<std::string> names_;
};

}  // namespace

std::unique_ptr<Detector> OpenDetector(const std::string& path, const DetectorSettings& settings) {
  settings.Check();
  try {
    return std::make_unique<OnnxDetector>(path, settings);
  } catch (const Error& error) {
    throw Error(error.kind(), path + ": " + error.what());
  }
}

}  // namespace alidade
