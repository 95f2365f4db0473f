// Properties of an ONNX file that OpenCV reads but does not expose.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

struct OnnxInput {
  std::string name;
  int element_type = 0;  // TensorProto.DataType: 1 float, 2 uint8, 10 half float, …; 0: not stated
  std::vector<int64_t> shape;  // -1: variable; empty when not stated
};

struct OnnxModel {
  std::vector<OnnxInput> inputs;  // without the network's constants
  // The first layer works on single pixels, per channel: it subtracts a mean or scales.
  bool normalises_input = false;
  bool external_weights = false;  // the weights are in another file
  std::string class_names;        // as the exporter wrote them, see ParseClassNames; often empty
};

// Throws Error (input) when a file with these first bytes is not an ONNX model. Allows rejecting it
// before all of it is read.
void CheckOnnxStart(std::string_view start);

// Throws Error (input) when the bytes are not an ONNX model, have more parts than a detector needs,
// or are damaged in the parts read here.
OnnxModel ReadOnnxModel(std::string_view bytes);

}  // namespace alidade
