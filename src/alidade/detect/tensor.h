// Header of a constant in an ONNX file (TensorProto). Checks that the data has the size its shape
// requires, because OpenCV reads past the end of data that is too short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace alidade {

inline constexpr size_t kMostOnnxSides = 32;  // the limit of OpenCV's arrays

struct OnnxTensor {
  std::string_view name;
  std::vector<int64_t> shape;
  bool external = false;  // the data is in another file
};

// Throws Error (input) when the tensor is damaged or its data does not match its shape.
OnnxTensor ReadTensor(std::string_view bytes);

}  // namespace alidade
