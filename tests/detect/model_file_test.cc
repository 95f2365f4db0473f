#include "alidade/detect/model_file.h"

#include <gtest/gtest.h>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/detect/protobuf.h"
#include "detect/tiny_network.h"
#include "support/expect_error.h"

namespace alidade::model_file_test {
namespace {

using Shape = std::vector<int64_t>;

TinyNetwork Tiny() {
  TinyNetwork network({1, 3 * kTinyCells, 7}, 0);
  network.names = "['a', 'b']";
  return network;
}

TEST(OnnxModel, SaysWhatIsInTheFile) {
  const OnnxModel model = ReadOnnxModel(Tiny().Bytes());
  ASSERT_EQ(model.inputs.size(), 1u);
  EXPECT_EQ(model.inputs[0].name, "images");
  EXPECT_EQ(model.inputs[0].element_type, 1);
  EXPECT_EQ(model.inputs[0].shape, (Shape{1, 3, 32, 32}));
  EXPECT_FALSE(model.normalises_input);
  EXPECT_FALSE(model.external_weights);
  EXPECT_EQ(model.class_names, "['a', 'b']");
}

TEST(OnnxModel, KnowsSidesLeftOpen) {
  TinyNetwork network = Tiny();
  network.input = {-1, 3, 0, -1};
  EXPECT_EQ(ReadOnnxModel(network.Bytes()).inputs[0].shape, (Shape{-1, 3, -1, -1}));
}

TEST(OnnxModel, DoesNotTakeWeightsForInputs) {
  OnnxFile file = Tiny().File();
  file.Input("weights", {441, 3, 1, 1});  // as old exporters do
  EXPECT_EQ(ReadOnnxModel(file.Bytes()).inputs.size(), 1u);
}

TEST(OnnxModel, KnowsNetworksThatNormaliseTheirInput) {
  TinyNetwork network = Tiny();
  network.scales_input = true;
  EXPECT_TRUE(ReadOnnxModel(network.Bytes()).normalises_input);
  for (const char* operation : {"Sub", "Mul", "Div", "Add", "BatchNormalization"}) {
    OnnxFile file;
    file.Input("x", {1, 3, 32, 32}).Constant("mean", {1}, {9}).Node(operation, {"x", "mean"}, "y");
    EXPECT_TRUE(ReadOnnxModel(file.Bytes()).normalises_input) << operation;
  }
  for (const char* operation : {"Slice", "Relu", "Conv"}) {
    OnnxFile file;
    file.Input("x", {1, 3, 32, 32}).Constant("w", {1, 3, 1, 1}, {1, 2, 3});
    file.Node(operation, {"x", "w"}, "y").Node("Mul", {"y", "y"}, "z");
    EXPECT_FALSE(ReadOnnxModel(file.Bytes()).normalises_input) << operation;
  }
}

TEST(OnnxModel, RefusesLayersThatWorkOnNothing) {
  OnnxFile file;
  file.Input("x", {1, 3, 32, 32}).Node("Conv", {"x", "weights"}, "y");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadOnnxModel(file.Bytes()); }),
              testing::HasSubstr("does not exist"));
}

TEST(OnnxModel, RefusesConstantsThatAreTooShortOrTooLong) {
  for (const Shape& shape : {Shape{3}, Shape{1}, Shape{-2}, Shape{1 << 30, 1 << 30, 1 << 30}}) {
    OnnxFile file;
    file.Input("x", {2}).Constant("c", shape, {1, 2}).Node("Add", {"x", "c"}, "y");
    EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadOnnxModel(file.Bytes()); }),
                testing::HasSubstr("is damaged"));
  }
}

// Memory must not grow without limit for a crafted file, in which a part of 2 bytes takes about 100
// bytes of memory.
TEST(OnnxModel, RefusesMoreThanANetworkCanHave) {
  const auto bytes = [](const std::string& graph) {
    return ProtobufWriter().Integer(1, 7).Bytes(7, graph).text();
  };
  ProtobufWriter layers, inputs, sides, constant;
  for (int i = 0; i < 100001; ++i) {
    layers.Bytes(1, "");
    inputs.Bytes(1, "");
  }
  for (const std::string& graph :
       {layers.text(), ProtobufWriter().Bytes(1, inputs.text()).text()}) {
    EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadOnnxModel(bytes(graph)); }),
                testing::HasSubstr("more than 100000 parts"));
  }
  for (int i = 0; i < 33; ++i) {
    sides.Bytes(1, "");
    constant.Integer(1, 1);
  }
  const auto shape = ProtobufWriter().Bytes(2, sides.text()).text();
  const auto type = ProtobufWriter().Bytes(1, shape).text();
  const auto input = ProtobufWriter().Bytes(2, type).text();
  for (const std::string& graph : {ProtobufWriter().Bytes(11, input).text(),
                                   ProtobufWriter().Bytes(5, constant.text()).text()}) {
    EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadOnnxModel(bytes(graph)); }),
                testing::HasSubstr("too many dimensions"));
  }
}

// Damaged files are read or throw an Error, without invalid memory accesses (checked by the
// sanitizers).
TEST(OnnxModel, SurvivesDamagedFiles) {
  const std::string good = Tiny().Bytes();
  Random random(11);
  int refused = 0;
  const auto read = [&refused](const std::string& bytes) {
    try {
      ReadOnnxModel(bytes);
    } catch (const Error&) {
      ++refused;
    }
  };
  for (size_t size = 0; size < good.size(); size += 7) read(good.substr(0, size));
  EXPECT_GT(refused, 100);
  for (int round = 0; round < 5000; ++round) {
    std::string bytes = good;
    const uint32_t changes = 1 + random.Below(8);
    for (uint32_t i = 0; i < changes; ++i) {
      // Half of the changes hit the first kilobyte, which contains lengths and names.
      const auto reach = static_cast<uint32_t>(random.Below(2) == 0 ? 1024 : bytes.size());
      const uint32_t at = random.Below(reach);
      bytes[at] = static_cast<char>(random.Below(256));
    }
    read(bytes);
  }
  EXPECT_GT(refused, 1000);
}

TEST(Protobuf, StopsWhereAMessageIsDamaged) {
  for (const std::string& bytes :
       {std::string("\x0a\x05"
                    "abc"),
        std::string("\x08"), std::string("\x08\xff\xff"),
        std::string("\x0a\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"), std::string("\x0b"),
        std::string("\x0d\x01\x02"), std::string("\x00\x01", 2),
        std::string("\x0a\xff\xff\xff\xff\xff\xff\xff\xff\x7f"
                    "x")}) {
    ProtobufReader reader(bytes);
    EXPECT_FALSE(reader.Next());
    EXPECT_TRUE(reader.damaged());
    EXPECT_FALSE(reader.Next());
  }
}

TEST(Protobuf, ReadsRepeatedIntegersEitherWay) {
  ProtobufField packed;
  packed.bytes = std::string_view("\x03\x80\x01\x07", 4);
  EXPECT_EQ(Integers(packed, 9), (std::vector<uint64_t>{3, 128, 7}));
  ProtobufField single;
  single.is_integer = true;
  single.value = 9;
  EXPECT_EQ(Integers(single, 9), std::vector<uint64_t>{9});
}

}  // namespace
}  // namespace alidade::model_file_test
