// Writes small ONNX files with the field numbers of onnx.proto: networks with known outputs, and
// files with one specific error.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace alidade {

// Builds a protocol buffers message.
class ProtobufWriter {
 public:
  ProtobufWriter& Integer(int number, int64_t value) {
    Varint(static_cast<uint64_t>(number) << 3);
    Varint(static_cast<uint64_t>(value));
    return *this;
  }
  ProtobufWriter& Bytes(int number, const std::string& bytes) {
    Varint(static_cast<uint64_t>(number) << 3 | 2);
    Varint(bytes.size());
    text_ += bytes;
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  void Varint(uint64_t value) {
    for (; value >= 0x80; value >>= 7) text_ += static_cast<char>(value | 0x80);
    text_ += static_cast<char>(value);
  }
  std::string text_;
};

class OnnxFile {
 public:
  static constexpr int kFloat = 1, kUint8 = 2, kInt64 = 7;

  // A size of -1 is variable.
  OnnxFile& Input(const std::string& name, const std::vector<int64_t>& shape, int type = kFloat) {
    graph_.Bytes(11, ValueInfo(name, shape, type));
    return *this;
  }
  OnnxFile& Output(const std::string& name, const std::vector<int64_t>& shape) {
    graph_.Bytes(12, ValueInfo(name, shape, kFloat));
    return *this;
  }
  OnnxFile& Constant(const std::string& name, const std::vector<int64_t>& shape,
                     const std::vector<float>& values) {
    return Tensor(name, shape, kFloat, Raw(values));
  }
  OnnxFile& Constant(const std::string& name, const std::vector<int64_t>& values) {
    return Tensor(name, {static_cast<int64_t>(values.size())}, kInt64, Raw(values));
  }
  // A constant whose data is stated to be in another file.
  OnnxFile& ExternalConstant(const std::string& name, const std::vector<int64_t>& shape) {
    ProtobufWriter tensor;
    for (const int64_t side : shape) tensor.Integer(1, side);
    tensor.Integer(2, kFloat).Bytes(8, name).Integer(14, 1);
    graph_.Bytes(5, tensor.text());
    return *this;
  }
  // An attribute with one value is an integer, with several a list.
  OnnxFile& Node(const std::string& operation, const std::vector<std::string>& inputs,
                 const std::string& output,
                 const std::vector<std::pair<std::string, std::vector<int64_t>>>& attributes = {}) {
    ProtobufWriter node;
    for (const std::string& input : inputs) node.Bytes(1, input);
    node.Bytes(2, output).Bytes(3, output).Bytes(4, operation);
    for (const auto& [name, values] : attributes) {
      ProtobufWriter attribute;
      attribute.Bytes(1, name);
      if (values.size() == 1) {
        attribute.Integer(3, values[0]).Integer(20, 2);
      } else {
        for (const int64_t value : values) attribute.Integer(8, value);
        attribute.Integer(20, 7);
      }
      node.Bytes(5, attribute.text());
    }
    graph_.Bytes(1, node.text());
    return *this;
  }
  OnnxFile& Metadata(const std::string& key, const std::string& value) {
    metadata_.Bytes(14, ProtobufWriter().Bytes(1, key).Bytes(2, value).text());
    return *this;
  }

  std::string Bytes() const {
    return ProtobufWriter()
               .Integer(1, 7)
               .Bytes(7, graph_.text())
               .Bytes(8, ProtobufWriter().Bytes(1, "").Integer(2, 13).text())
               .text() +
           metadata_.text();
  }

 private:
  template <typename T>
  static std::string Raw(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  }
  static std::string ValueInfo(const std::string& name, const std::vector<int64_t>& shape,
                               int type) {
    ProtobufWriter sides;
    for (const int64_t side : shape) {
      ProtobufWriter dimension;
      if (side < 0) {
        dimension.Bytes(2, "open");
      } else {
        dimension.Integer(1, side);
      }
      sides.Bytes(1, dimension.text());
    }
    const ProtobufWriter tensor = ProtobufWriter().Integer(1, type).Bytes(2, sides.text());
    return ProtobufWriter()
        .Bytes(1, name)
        .Bytes(2, ProtobufWriter().Bytes(1, tensor.text()).text())
        .text();
  }
  OnnxFile& Tensor(const std::string& name, const std::vector<int64_t>& shape, int type,
                   const std::string& raw) {
    ProtobufWriter tensor;
    for (const int64_t side : shape) tensor.Integer(1, side);
    tensor.Integer(2, type).Bytes(8, name).Bytes(9, raw);
    graph_.Bytes(5, tensor.text());
    return *this;
  }

  ProtobufWriter graph_, metadata_;
};

}  // namespace alidade
