#include "alidade/detect/onnx/open_detector.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/detect/onnx/network_module.h"
#include "alidade/detect/yolo_model.h"

namespace alidade {
namespace {

constexpr size_t kMostNetworkBytes = size_t{1} << 30;  // the largest YOLO has 0.4 GB
constexpr char kAdvice[] = "; the YOLOv5 and YOLOX families work, others may need a newer OpenCV";

// Checks size and first bytes before it allocates memory, because a sparse file can be large
// without using disk space.
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
               " MB, which is too long for a detector");
  std::string bytes(std::min<size_t>(size, 1), '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
  CheckOnnxStart(bytes);
  bytes.resize(size);
  if (!stream.read(bytes.data() + 1, static_cast<std::streamsize>(size - 1))) fail();
  return bytes;
}

std::unique_ptr<Network> OpenNetwork(const std::string& bytes) {
  static const LoadedModule module = LoadModule(kDnnModuleFile, {"alidade_dnn_open"});
  if (module.symbols.empty())
    ThrowInput(std::string("needs ") + kDnnModuleFile + ": " + module.problem);
  const auto open = reinterpret_cast<NetworkOpenFunction*>(module.symbols[0]);
  std::string problem;
  std::unique_ptr<Network> network(open(bytes.data(), bytes.size(), &problem));
  if (!network)
    ThrowInput("is not a network that OpenCV " CV_VERSION " can read: " + problem + kAdvice);
  return network;
}

NetworkOutput ViewOf(const cv::Mat& output) {
  if (output.type() != CV_32F || !output.isContinuous())
    ThrowInput("has an output that is not an array of floats");
  return {{output.size.p, output.size.p + output.dims}, {output.ptr<float>(), output.total()}};
}

class OnnxDetector : public Detector {
 public:
  OnnxDetector(const std::string& path, const std::string& bytes, const DetectorSettings& settings)
      : path_(path), model_(bytes, settings), network_(OpenNetwork(bytes)) {
    std::vector<cv::Mat> outputs;
    const std::string problem = network_->Run(model_.TrialInput(), kAllOutputs, &outputs);
    if (!problem.empty()) {
      ThrowInput("is not a network that OpenCV " CV_VERSION " can run: " + problem +
                 (model_.leaves_size_open()
                      ? "; its input size is not fixed: export it with a fixed one"
                      : kAdvice));
    }
    std::vector<NetworkOutput> views;
    views.reserve(outputs.size());
    for (const cv::Mat& output : outputs) views.push_back(ViewOf(output));
    model_.Recognise(views);
  }

  std::vector<Detection> Detect(const cv::Mat& image) override try {
    std::vector<cv::Mat> outputs;
    const std::string problem = network_->Run(model_.Prepare(image), model_.output(), &outputs);
    if (!problem.empty()) ThrowInput("the network failed: " + problem);
    return model_.Read(ViewOf(outputs.at(0)), image.size());
  } catch (const Error& error) {
    throw Error(error.kind(), path_ + ": " + error.what());
  }

  const std::vector<std::string>& ClassNames() const override { return model_.class_names(); }

 private:
  std::string path_;
  YoloModel model_;
  std::unique_ptr<Network> network_;
};

}  // namespace

std::unique_ptr<Detector> OpenDetector(const std::string& path, const DetectorSettings& settings) {
  settings.Check();
  try {
    return std::make_unique<OnnxDetector>(path, ReadNetworkFile(path), settings);
  } catch (const Error& error) {
    throw Error(error.kind(), path + ": " + error.what());
  }
}

}  // namespace alidade
