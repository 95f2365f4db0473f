#include "alidade/detect/model_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "alidade/base/error.h"
#include "alidade/detect/protobuf.h"
#include "alidade/detect/tensor.h"

namespace alidade {
namespace {

// Field numbers of onnx.proto.
namespace model {
enum { kIrVersion = 1, kGraph = 7, kMetadata = 14 };
}
namespace graph {
enum { kNode = 1, kInitializer = 5, kInput = 11 };
}
namespace node {
enum { kInput = 1, kOutput = 2, kOperation = 4, kAttribute = 5 };
}
namespace attribute {
enum { kTensor = 5 };
}
namespace value_info {
enum { kName = 1, kType = 2 };
}
namespace type {
enum { kTensor = 1 };
}
namespace tensor_type {
enum { kElementType = 1, kShape = 2 };
}
namespace shape {
enum { kDim = 1 };
}
namespace dimension {
enum { kValue = 1 };
}
namespace entry {
enum { kKey = 1, kValue = 2 };
}

constexpr uint64_t kMostIrVersion = 100;  // version 13 in 2025
constexpr int64_t kOpenSide = -1;
// Limit of the number of layers, their inputs and outputs, and constants. The largest YOLO has
// about a thousand. In a crafted file each part takes as little as 2 bytes, but about 100 bytes of
// memory.
constexpr int kMostParts = 100000;

struct Node {
  std::string_view operation;
  std::vector<std::string_view> inputs, outputs;
};

class PartCounter {
 public:
  void Add() {
    if (++parts_ > kMostParts)
      ThrowInput("is not a detector: its layers and constants have more than " +
                 std::to_string(kMostParts) + " parts");
  }

 private:
  int parts_ = 0;
};

struct Graph {
  std::vector<Node> nodes;
  std::vector<OnnxInput> inputs;
  std::map<std::string_view, std::vector<int64_t>> constants;  // name -> shape
  bool external_weights = false;
};

// Calls visit(field) for each field. Throws Error (input) when the message is damaged.
template <typename Visit>
void ForEachField(std::string_view message, const Visit& visit) {
  ProtobufReader reader(message);
  while (const std::optional<ProtobufField> field = reader.Next()) visit(*field);
  if (reader.damaged()) ThrowInput("is damaged or truncated");
}

Node ReadNode(std::string_view bytes, PartCounter& count) {
  Node read;
  ForEachField(bytes, [&](const ProtobufField& field) {
    count.Add();
    if (field.number == node::kInput) read.inputs.push_back(field.bytes);
    if (field.number == node::kOutput) read.outputs.push_back(field.bytes);
    if (field.number == node::kOperation) read.operation = field.bytes;
    if (field.number != node::kAttribute) return;
    ForEachField(field.bytes, [](const ProtobufField& part) {
      if (part.number == attribute::kTensor) ReadTensor(part.bytes);  // only to check it
    });
  });
  return read;
}

void ReadConstant(std::string_view bytes, Graph* read) {
  OnnxTensor tensor = ReadTensor(bytes);
  read->external_weights |= tensor.external;
  read->constants[tensor.name] = std::move(tensor.shape);
}

// Size of one dimension; kOpenSide when it is variable. Exporters write a name, 0 or -1 for that.
int64_t ReadSide(std::string_view bytes) {
  int64_t side = kOpenSide;
  ForEachField(bytes, [&](const ProtobufField& field) {
    if (field.number == dimension::kValue && field.is_integer && field.value > 0)
      side = std::max(static_cast<int64_t>(field.value), kOpenSide);
  });
  return side;
}

void ReadTensorType(std::string_view bytes, OnnxInput* input) {
  ForEachField(bytes, [&](const ProtobufField& field) {
    if (field.number == tensor_type::kElementType)
      input->element_type = static_cast<int>(std::min<uint64_t>(field.value, 1000));
    if (field.number != tensor_type::kShape) return;
    ForEachField(field.bytes, [&](const ProtobufField& side) {
      if (side.number != shape::kDim) return;
      if (input->shape.size() == kMostOnnxSides)
        ThrowInput("is damaged: an input has too many dimensions");
      input->shape.push_back(ReadSide(side.bytes));
    });
  });
}

OnnxInput ReadInput(std::string_view bytes) {
  OnnxInput input;
  ForEachField(bytes, [&](const ProtobufField& field) {
    if (field.number == value_info::kName) input.name = field.bytes;
    if (field.number != value_info::kType) return;
    ForEachField(field.bytes, [&](const ProtobufField& type) {
      if (type.number == type::kTensor) ReadTensorType(type.bytes, &input);
    });
  });
  return input;
}

// Checks that every layer's inputs are constants, inputs of the graph or outputs of earlier layers,
// because OpenCV does not.
void CheckConnections(const Graph& read) {
  std::set<std::string_view> known;
  for (const OnnxInput& input : read.inputs) known.insert(input.name);
  for (const auto& [name, shape] : read.constants) known.insert(name);
  for (const Node& node : read.nodes) {
    for (const std::string_view input : node.inputs) {
      if (!input.empty() && known.count(input) == 0)
        ThrowInput("is damaged: a layer has an input that does not exist");
    }
    known.insert(node.outputs.begin(), node.outputs.end());
  }
}

Graph ReadGraph(std::string_view bytes) {
  Graph read;
  PartCounter count;
  ForEachField(bytes, [&](const ProtobufField& field) {
    count.Add();
    if (field.number == graph::kNode) read.nodes.push_back(ReadNode(field.bytes, count));
    if (field.number == graph::kInitializer) ReadConstant(field.bytes, &read);
    if (field.number == graph::kInput) read.inputs.push_back(ReadInput(field.bytes));
  });
  // early versions of the format list the weights among the inputs
  std::erase_if(read.inputs,
                [&](const OnnxInput& input) { return read.constants.count(input.name) > 0; });
  CheckConnections(read);
  return read;
}

// true when the first layer is arithmetic with a constant, a batch normalization, or a convolution
// with one 1 × 1 filter per channel.
bool NormalisesInput(const Graph& read) {
  constexpr std::array<std::string_view, 5> kArithmetic = {"Sub", "Add", "Mul", "Div",
                                                           "BatchNormalization"};
  if (read.inputs.empty()) return false;
  for (const Node& node : read.nodes) {
    if (std::count(node.inputs.begin(), node.inputs.end(), read.inputs[0].name) == 0) continue;
    if (std::count(kArithmetic.begin(), kArithmetic.end(), node.operation) > 0) return true;
    if (node.operation != "Conv" || node.inputs.size() < 2) return false;
    const auto weights = read.constants.find(node.inputs[1]);
    return weights != read.constants.end() && weights->second == std::vector<int64_t>{3, 1, 1, 1};
  }
  return false;
}

std::string ReadClassNames(std::string_view metadata) {
  std::string_view key, value;
  ForEachField(metadata, [&](const ProtobufField& field) {
    if (field.number == entry::kKey) key = field.bytes;
    if (field.number == entry::kValue) value = field.bytes;
  });
  return key == "names" ? std::string(value) : "";
}

}  // namespace

void CheckOnnxStart(std::string_view start) {
  if (start.empty()) ThrowInput("is empty");
  // The first byte holds a field number, which is at least 1. A sparse file begins with zeros.
  if (static_cast<unsigned char>(start.front()) >> 3 == 0) ThrowInput("is not an ONNX file");
}

OnnxModel ReadOnnxModel(std::string_view bytes) {
  if (bytes.empty()) ThrowInput("is empty");
  OnnxModel read;
  bool version = false;
  std::optional<Graph> graph;
  ProtobufReader reader(bytes);
  while (const std::optional<ProtobufField> field = reader.Next()) {
    if (field->number == model::kIrVersion)
      version = field->is_integer && field->value > 0 && field->value <= kMostIrVersion;
    if (!version) continue;  // the version comes first; without it the file is not an ONNX model
    if (field->number == model::kGraph) graph = ReadGraph(field->bytes);
    if (field->number == model::kMetadata && read.class_names.empty())
      read.class_names = ReadClassNames(field->bytes);
  }
  if (!version) ThrowInput("is not an ONNX file");
  if (reader.damaged()) ThrowInput("is damaged or truncated");
  if (!graph || graph->nodes.empty())
    ThrowInput("contains no network: it is not an ONNX file, or incomplete");
  read.normalises_input = NormalisesInput(*graph);
  read.external_weights = graph->external_weights;
  read.inputs = std::move(graph->inputs);
  return read;
}

}  // namespace alidade
