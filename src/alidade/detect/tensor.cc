#include "alidade/detect/tensor.h"

#include <optional>

#include "alidade/base/error.h"
#include "alidade/detect/protobuf.h"

namespace alidade {
namespace {

// Field numbers of TensorProto.
enum FieldNumber {
  kDims = 1,
  kDataType = 2,
  kFloatData = 4,
  kInt32Data = 5,
  kInt64Data = 7,
  kName = 8,
  kRawData = 9,
  kDoubleData = 10,
  kUint64Data = 11,
  kDataLocation = 14,
};

constexpr int64_t kMostNumbers = int64_t{1} << 31;  // 8 GB of floats

// Bytes per element for each TensorProto.DataType: none, float, uint8, int8, uint16, int16, int32,
// int64, string, bool, half, double, uint32, uint64. 0: not checked.
constexpr size_t kBytesOf[] = {0, 4, 1, 1, 2, 2, 4, 8, 0, 1, 2, 8, 4, 8};

// Number of elements; nullopt for a negative size or more than kMostNumbers elements.
std::optional<uint64_t> CountOf(const std::vector<int64_t>& shape) {
  int64_t count = 1;
  for (const int64_t side : shape) {
    if (side < 0 || (side > 0 && count > kMostNumbers / side)) return std::nullopt;
    count *= side;
  }
  return static_cast<uint64_t>(count);
}

}  // namespace

OnnxTensor ReadTensor(std::string_view bytes) {
  OnnxTensor tensor;
  uint64_t type = 0, raw_bytes = 0, numbers = 0;
  ProtobufReader reader(bytes);
  while (const std::optional<ProtobufField> field = reader.Next()) {
    switch (field->number) {
      case kDims:
        for (const uint64_t side : Integers(*field, kMostOnnxSides + 1))
          tensor.shape.push_back(static_cast<int64_t>(side));
        if (tensor.shape.size() > kMostOnnxSides)
          ThrowInput("is damaged: a constant has too many dimensions");
        break;
      case kDataType:
        type = field->value;
        break;
      case kName:
        tensor.name = field->bytes;
        break;
      case kRawData:
        raw_bytes = field->bytes.size();
        break;
      case kFloatData:
        numbers += field->bytes.size() / sizeof(float);
        break;
      case kDoubleData:
        numbers += field->bytes.size() / sizeof(double);
        break;
      case kInt32Data:
      case kInt64Data:
      case kUint64Data:
        numbers += CountIntegers(*field);
        break;
      case kDataLocation:
        tensor.external = field->value == 1;
        break;
      default:
        break;
    }
  }
  const std::optional<uint64_t> count = CountOf(tensor.shape);
  if (reader.damaged() || !count) ThrowInput("is damaged or truncated");
  const size_t size = type < std::size(kBytesOf) ? kBytesOf[type] : 0;
  if (tensor.external || size == 0) return tensor;
  if (raw_bytes > 0 ? raw_bytes != *count * size : numbers != *count)
    ThrowInput("is damaged: the size of a constant does not match its shape");
  return tensor;
}

}  // namespace alidade
