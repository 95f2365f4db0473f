#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "alidade/base/printable.h"
#include "alidade/detect/onnx/network_module.h"

namespace alidade {
namespace {

constexpr size_t kLongest = 200;  // characters of an error message

// The text between `before` and the first of the characters `ends` after it; "" when `before` is
// missing.
std::string Between(const std::string& text, const std::string& before, const char* ends) {
  const size_t at = text.find(before);
  if (at == std::string::npos) return "";
  const size_t from = at + before.size();
  return text.substr(from, text.find_first_of(ends, from) - from);
}

// Removes unprintable characters, which may come from a damaged file, and shortens the text.
std::string Shown(const std::string& text) { return Printable(text).substr(0, kLongest); }

// Reduces OpenCV's multi-line message to one line that names the unsupported operator.
std::string Reason(const cv::Exception& error) {
  const std::string text = error.what();
  std::string operation = Between(text, "Node [", "@]");
  if (operation.empty()) operation = Between(text, "of type \"", "\"");
  if (!operation.empty())
    return Shown("operator " + operation) + " is not known, or not used in this way";
  const std::string line = Shown(error.err.substr(0, error.err.find('\n')));
  return line.empty() ? "an unknown reason" : line;
}

// Runs `run` and returns the reason when it throws, else "".
template <typename Function>
std::string ReasonOf(const Function& run) {
  try {
    run();
  } catch (const cv::Exception& error) {
    return Reason(error);
  } catch (const std::bad_alloc&) {
    return "not enough memory";
  } catch (const std::exception& error) {
    return Shown(error.what());
  } catch (...) {
    return "an unknown reason";
  }
  return "";
}

class DnnNetwork : public Network {
 public:
  explicit DnnNetwork(const cv::dnn::Net& net) : net_(net) {
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);  // gives the same bits on every machine
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    names_ = net_.getUnconnectedOutLayersNames();
  }

  std::string Run(const cv::Mat& input, int which, std::vector<cv::Mat>* outputs) override {
    outputs->clear();
    return ReasonOf([&] {
      net_.setInput(input);
      if (which == kAllOutputs) {
        net_.forward(*outputs, names_);
      } else {
        outputs->push_back(net_.forward(names_.at(static_cast<size_t>(which))));
      }
    });
  }

 private:
  cv::dnn::Net net_;
  std::vector<cv::String> names_;
};

}  // namespace
}  // namespace alidade

using alidade::DnnNetwork, alidade::Network, alidade::ReasonOf;

extern "C" __attribute__((visibility("default"))) Network* alidade_dnn_open(const char* bytes,
                                                                            size_t size,
                                                                            std::string* problem) {
  // The caller reports the problem.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  std::unique_ptr<Network> network;
  *problem = ReasonOf(
      [&] { network = std::make_unique<DnnNetwork>(cv::dnn::readNetFromONNX(bytes, size)); });
  return network.release();
}
