// The head of a constant in an ONNX file (TensorProto): its shape, and whether its numbers are all
// there. OpenCV reads past the end of what is too short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace alidade {

inline constexpr size_t kMostOnnxSides = 32;  // as many as OpenCV's arrays may have

struct OnnxTensor {
  std::string_view name;
  std::vector<int64_t> shape;
  bool external = false;  // its numbers are in another file
};

// Throws Error (input) when it is damaged, or holds more or fewer numbers than its shape says.
OnnxTensor ReadTensor(std::string_view bytes);

}  // namespace alidade
