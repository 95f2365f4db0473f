// A small network with known outputs: each output value is a constant plus a multiple of the mean
// of the input's red, green or blue plane.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "support/onnx_file.h"

namespace alidade {

// For an input of 32 × 32: 16 cells of 8 pixels, 4 of 16, 1 of 32.
inline constexpr int kTinySide = 32, kTinyCells = 21;

struct TinyNetwork {
  std::vector<int64_t> input = {1, 3, kTinySide, kTinySide};
  std::vector<int64_t> shape;  // of the output
  std::vector<float> values;   // of the output, for a black image
  // Adds `factor` times the mean of input plane `plane` to output value `index`.
  struct Dependence {
    size_t index;
    int plane;
    float factor;
  };
  std::vector<Dependence> dependences;
  bool scales_input = false;  // multiplies by 1 in its first layer
  std::string names;          // metadata

  TinyNetwork(std::vector<int64_t> output_shape, float fill) : shape(std::move(output_shape)) {
    size_t count = 1;
    for (const int64_t side : shape) count *= static_cast<size_t>(side);
    values.assign(count, fill);
  }
  float& At(int row, int column) { return values[static_cast<size_t>(row * shape[2] + column)]; }
  size_t Index(int row, int column) const { return static_cast<size_t>(row * shape[2] + column); }

  // A file whose output is called `last`, to append layers.
  OnnxFile File(const std::string& last) const {
    const auto count = static_cast<int64_t>(values.size());
    std::vector<float> weights(3 * values.size(), 0);  // one row per value
    for (const Dependence& d : dependences)
      weights[3 * d.index + static_cast<size_t>(d.plane)] = d.factor;
    OnnxFile file;
    file.Input("images", input);
    if (scales_input) {
      file.Constant("ones", {3, 1, 1, 1}, {1, 1, 1});
      file.Node("Conv", {"images", "ones"}, "scaled", {{"kernel_shape", {1, 1}}, {"group", {3}}});
    }
    file.Node("GlobalAveragePool", {scales_input ? "scaled" : "images"}, "means");
    file.Constant("weights", {count, 3, 1, 1}, weights);
    file.Constant("constants", {count}, values);
    file.Node("Conv", {"means", "weights", "constants"}, "numbers", {{"kernel_shape", {1, 1}}});
    file.Constant("shape", shape);
    file.Node("Reshape", {"numbers", "shape"}, last);
    if (!names.empty()) file.Metadata("names", names);
    return file;
  }
  OnnxFile File() const { return File("output0").Output("output0", shape); }
  std::string Bytes() const { return File().Bytes(); }
};

}  // namespace alidade
