// What an ONNX file says of itself, as far as a detector's user must know it: OpenCV reads the
// network but doesn't tell.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

struct OnnxInput {
  std::string name;
  int element_type = 0;  // TensorProto.DataType: 1 float, 2 uint8, 10 half float, …; 0 unsaid
  std::vector<int64_t> shape;  // -1: left open. Empty when the file doesn't say
};

struct OnnxModel {
  std::vector<OnnxInput> inputs;  // without those that are constants of the network
  bool normalises_input = false;  // its first layer works on single pixels, channel by channel:
                                  // it subtracts a mean, or scales
  bool external_weights = false;  // they are in another file
  std::string class_names;        // as the exporter wrote them, see ParseClassNames; often ""
};

// Throws Error (input) when a file that begins like this is no ONNX model: a look at it before all
// of it is read.
void CheckOnnxStart(std::string_view start);

// Throws Error (input) when the bytes are no ONNX model, hold more than a detector can need, or
// damaged as far as this is read.
OnnxModel ReadOnnxModel(std::string_view bytes);

}  // namespace alidade
