#include "alidade/detect/yolo_model.h"

#include <optional>

#include "alidade/base/error.h"
#include "alidade/detect/class_names.h"
#include "alidade/detect/letterbox.h"
#include "alidade/detect/suppress.h"

namespace alidade {
namespace {

constexpr int kStride = 32;  // of the coarsest cells, pixels: input sizes are multiples of it
constexpr int64_t kMostSide = 4096;  // pixels; a larger size means a damaged file
constexpr int kOpenSize = 640;       // pixels, both sides, when the file leaves the size open
constexpr int kTrialGrey = 114;
constexpr int kFloat = 1, kHalf = 10;  // TensorProto.DataType

cv::Size InputSize(const OnnxModel& model) {
  if (model.inputs.size() != 1)
    ThrowInput("has " + std::to_string(model.inputs.size()) +
               " inputs: a detector has one, the image");
  const OnnxInput& input = model.inputs[0];
  const std::vector<int64_t>& shape = input.shape;
  if (input.element_type > 0 && input.element_type != kFloat && input.element_type != kHalf)
    ThrowInput("has an input that is not float32: export it with a float32 input");
  if (shape.empty()) return {kOpenSize, kOpenSize};
  if (shape.size() != 4 || (shape[1] != 3 && shape[1] > 0))
    ThrowInput("does not take color images: its input must be 1 x 3 x height x width");
  if (shape[0] > 1) ThrowInput("takes several images at once: export it with batch size 1");
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

// The training's color order and scale do not follow from the outputs' shapes; see
// docs/guides/detectors.md.
InputConvention ConventionOf(const OnnxModel& model, const YoloLayout& layout) {
  const bool yolox = layout.family == YoloFamily::kAnchorFree && !layout.sure_of_objects;
  if (model.normalises_input) return {/*red_first=*/true, /*scale=*/1};
  if (yolox) return {/*red_first=*/false, /*scale=*/1};
  return {};
}

}  // namespace

YoloModel::YoloModel(std::string_view bytes, const DetectorSettings& settings)
    : model_(ReadOnnxModel(bytes)), settings_(settings) {
  settings_.Check();
  if (model_.external_weights)
    ThrowInput("stores its weights in another file: export it as a single file");
  input_ = InputSize(model_);
  leaves_size_open_ = LeavesSizeOpen(model_);
}

cv::Mat YoloModel::TrialInput() const {
  return ToNetworkInput(cv::Mat(input_, CV_8UC3, cv::Scalar::all(kTrialGrey)), {});
}

void YoloModel::Recognise(std::span<const NetworkOutput> outputs) {
  layout_ = RecogniseYolo(outputs, input_);
  convention_ = ConventionOf(model_, layout_);
  class_names_ = NamesFor(layout_.classes, ParseClassNames(model_.class_names));
}

cv::Mat YoloModel::Prepare(const cv::Mat& image) const {
  if (image.type() != CV_8UC3 && image.type() != CV_8UC1)
    ThrowInput("images must have one or three channels of 8 bits");
  return ToNetworkInput(Apply(FitInto(image.size(), input_), image), convention_);
}

std::vector<Detection> YoloModel::Read(const NetworkOutput& output, cv::Size image) const {
  std::vector<Detection> found = DecodeYolo(layout_, output, input_, settings_.min_score);
  for (const Detection& detection : found) {
    if (detection.class_id >= static_cast<int>(class_names_.size()))
      ThrowInput("the network gives class " + std::to_string(detection.class_id) + " of " +
                 std::to_string(class_names_.size()));
  }
  const Letterbox letterbox = FitInto(image, input_);
  std::vector<Detection> detections;
  for (Detection& detection : SuppressOverlaps(std::move(found), settings_.max_overlap)) {
    const std::optional<cv::Rect2f> box = ToImage(letterbox, detection.box);
    if (!box) continue;
    detection.box = *box;
    detections.push_back(detection);
  }
  return detections;
}

}  // namespace alidade
