#include "alidade/detect/class_names.h"
#include "alidade/detect/model_file.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {

void Onnx(std::string_view bytes) {
  const OnnxModel model = ReadOnnxModel(bytes);
  size_t sides = 0;
  for (const OnnxInput& input : model.inputs) {
    sides += input.shape.size();
    for (const int64_t side : input.shape) Expect(side >= -1, "an input's side is negative");
    Expect(input.element_type >= 0, "an input's type is negative");
  }
  Expect(sides <= bytes.size() && model.inputs.size() <= bytes.size(), "more than the file holds");
  ParseClassNames(model.class_names);
}

}  // namespace alidade::fuzz
