// Handwritten outputs for an input of 64 × 32: 32 cells of 8 pixels (8 per row), 8 of 16, 2 of 32.
#include "alidade/detect/yolo_output.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "alidade/base/random.h"
#include "support/expect_error.h"

namespace alidade::yolo_output_test {
namespace {

using testing::HasSubstr;

const cv::Size kInput(64, 32);
constexpr int kCells = 42;

struct Output {
  std::vector<int> shape;
  std::vector<float> values;

  explicit Output(std::vector<int> sides, float fill = 0) : shape(std::move(sides)) {
    size_t count = 1;
    for (const int side : shape) count *= static_cast<size_t>(side);
    values.assign(count, fill);
  }
  float& operator()(int i, int j) { return values[static_cast<size_t>(i * shape[2] + j)]; }
  void SetRow(int row, const std::vector<float>& numbers) {
    for (size_t i = 0; i < numbers.size(); ++i) (*this)(row, static_cast<int>(i)) = numbers[i];
  }
  NetworkOutput view() const { return {shape, values}; }
};

YoloLayout Recognise(const Output& output) {
  const NetworkOutput view = output.view();
  return RecogniseYolo({&view, 1}, kInput);
}

std::vector<Detection> Decode(const Output& output, float min_score = 0.25f) {
  return DecodeYolo(Recognise(output), output.view(), kInput, min_score);
}

std::string Complaint(const Output& output) {
  return MessageOf(ErrorKind::kInput, [&] { Recognise(output); });
}

TEST(YoloOutput, WithThreeAnchorsACellIsYolov5s) {
  Output output({1, 3 * kCells, 5 + 3});
  output.SetRow(7, {20, 16, 10, 6, 0.8f, 0.1f, 0.9f, 0.5f});
  output.SetRow(8, {20, 16, 10, 6, 0.3f, 0.1f, 0.8f, 0.5f});  // 0.24: too low
  EXPECT_EQ(Recognise(output).family, YoloFamily::kAnchors);
  EXPECT_EQ(Recognise(output).classes, 3);
  const auto found = Decode(output);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].class_id, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.72f);
  EXPECT_EQ(found[0].box, cv::Rect2f(15, 13, 10, 6));
}

TEST(YoloOutput, BoxesAreClippedToTheInput) {
  Output output({1, 3 * kCells, 6});
  output.SetRow(0, {60, 4, 20, 20, 1, 1});
  output.SetRow(1, {90, 4, 10, 10, 1, 1});
  output.SetRow(2, {3e38f, 0, 3e38f, 3e38f, 1, 1});
  const auto found = Decode(output);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].box, cv::Rect2f(50, 0, 14, 14));
  EXPECT_TRUE(found[1].box.empty());
  for (const Detection& detection : found)
    EXPECT_TRUE(std::isfinite(detection.box.width) && detection.box.x <= 64);
}

TEST(YoloOutput, TransposedIsYolov8s) {
  Output output({1, 4 + 2, kCells});
  const float numbers[6] = {32, 16, 8, 12, 0.3f, 0.6f};
  for (int i = 0; i < 6; ++i) output(i, 30) = numbers[i];
  EXPECT_EQ(Recognise(output).family, YoloFamily::kTransposed);
  EXPECT_EQ(Recognise(output).classes, 2);
  const auto found = Decode(output);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].class_id, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.6f);
  EXPECT_EQ(found[0].box, cv::Rect2f(28, 10, 8, 12));
}

TEST(YoloOutput, SixNumbersARowAreCornersScoreAndClass) {
  Output output({1, 300, 6});
  output.SetRow(0, {10, 5, 30, 25, 0.9f, 41});
  output.SetRow(1, {10, 5, 30, 25, 0.1f, 41});
  EXPECT_EQ(Recognise(output).family, YoloFamily::kSuppressed);
  const auto found = Decode(output);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].class_id, 41);
  EXPECT_EQ(found[0].box, cv::Rect2f(10, 5, 20, 20));
  output(0, 5) = -1;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { Decode(output); }), HasSubstr("class -1"));
}

// Cell of a row of an anchor-free output: column, row, size in pixels.
struct Cell {
  int x, y, stride;
};
std::vector<Cell> AllCells() {
  std::vector<Cell> cells;
  for (const int stride : {8, 16, 32}) {
    for (int y = 0; y < 32 / stride; ++y) {
      for (int x = 0; x < 64 / stride; ++x) cells.push_back({x, y, stride});
    }
  }
  return cells;
}

TEST(YoloOutput, UndecodedYoloxIsOffsetsAndLogarithms) {
  Output output({1, kCells, 6});
  const int row = 32 + 4 + 2;  // of the 16-pixel cells, the one at column 2, row 1
  output.SetRow(row, {0.25f, 0.5f, std::log(2.0f), std::log(0.5f), 0.9f, 1});
  EXPECT_FALSE(Recognise(output).decoded);
  const auto found = Decode(output);
  ASSERT_EQ(found.size(), 1u);
  // Center (2.25, 1.5) · 16 = (36, 24), size (32, 8).
  EXPECT_NEAR(found[0].box.x, 20, 1e-4);
  EXPECT_NEAR(found[0].box.y, 20, 1e-4);
  EXPECT_NEAR(found[0].box.width, 32, 1e-4);
  EXPECT_NEAR(found[0].box.height, 8, 1e-4);
}

// The same boxes in both forms are distinguished and decoded to the same result, for regressions of
// various spreads.
TEST(YoloOutput, DecodedAndUndecodedYoloxAreToldApart) {
  Random random(3);
  for (const double spread : {0.0, 0.3, 1.0, 2.0}) {
    Output raw({1, kCells, 6}), decoded({1, kCells, 6});
    const std::vector<Cell> cells = AllCells();
    ASSERT_EQ(cells.size(), static_cast<size_t>(kCells));
    for (int row = 0; row < kCells; ++row) {
      const Cell& cell = cells[static_cast<size_t>(row)];
      std::vector<float> numbers;
      for (int i = 0; i < 2; ++i)
        numbers.push_back(static_cast<float>(0.5 + spread * random.Uniform(-1, 1)));
      for (int i = 0; i < 2; ++i)
        numbers.push_back(static_cast<float>(1 + spread * random.Uniform(-1, 1)));
      numbers.insert(numbers.end(), {0.9f, 0.9f});
      raw.SetRow(row, numbers);
      const auto stride = static_cast<float>(cell.stride);
      numbers[0] = (numbers[0] + static_cast<float>(cell.x)) * stride;
      numbers[1] = (numbers[1] + static_cast<float>(cell.y)) * stride;
      numbers[2] = std::exp(numbers[2]) * stride;
      numbers[3] = std::exp(numbers[3]) * stride;
      decoded.SetRow(row, numbers);
    }
    EXPECT_FALSE(Recognise(raw).decoded) << spread;
    EXPECT_TRUE(Recognise(decoded).decoded) << spread;
    const auto a = Decode(raw), b = Decode(decoded);
    ASSERT_EQ(a.size(), static_cast<size_t>(kCells));
    ASSERT_EQ(b.size(), a.size());
    for (size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a[i].box.x, b[i].box.x, 1e-3);
      EXPECT_NEAR(a[i].box.height, b[i].box.height, 1e-3);
    }
  }
}

TEST(YoloOutput, OfSegmentingNetworksTheMasksAreLeftOut) {
  Output boxes({1, 4 + 2 + 32, kCells}, 0), prototypes({1, 32, 8, 16});
  for (int i = 6; i < 38; ++i) boxes(i, 3) = -7;  // mask coefficients are not scores
  boxes(5, 3) = 0.5f;
  const NetworkOutput both[] = {prototypes.view(), boxes.view()};
  const YoloLayout layout = RecogniseYolo(both, kInput);
  EXPECT_EQ(layout.output, 1);
  EXPECT_EQ(layout.classes, 2);
  EXPECT_EQ(DecodeYolo(layout, boxes.view(), kInput, 0.25f).size(), 1u);
}

TEST(YoloOutput, OfSeveralTheOneThatIsKnownCounts) {
  const Output head({1, 3, 4, 8}), boxes({1, 3 * kCells, 7});  // as in older YOLOv5 exports
  const NetworkOutput both[] = {head.view(), boxes.view()};
  EXPECT_EQ(RecogniseYolo(both, kInput).output, 1);
}

TEST(YoloOutput, OtherShapesAreSaidWithWhatIsKnown) {
  for (const auto& shape : {std::vector<int>{1, 1000},
                            {1, 3, 4, 8, 85},
                            {2, 126, 7},
                            {1, 126, 5},
                            {1, 125, 85},
                            {1, 4, 42}}) {
    const std::string message = Complaint(Output(shape));
    EXPECT_THAT(message,
                HasSubstr("[" + std::to_string(shape[0]) + ", " + std::to_string(shape[1])));
    EXPECT_THAT(message, HasSubstr("64x32"));
    EXPECT_THAT(message, HasSubstr("[1, 126, 5+C]"));
    EXPECT_THAT(message, HasSubstr("[1, 4+C, 42]"));
  }
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { RecogniseYolo({}, kInput); }), HasSubstr("none"));
}

TEST(YoloOutput, ValuesThatAreNotFiniteAreAnError) {
  for (const float value : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    for (const auto& shape : {std::vector<int>{1, 126, 7}, {1, 42, 7}, {1, 7, 42}, {1, 9, 6}}) {
      Output output(shape);
      const YoloLayout layout = Recognise(output);
      output.values[5] = value;
      EXPECT_THAT(Complaint(output), HasSubstr("not finite"));
      EXPECT_THROW(DecodeYolo(layout, output.view(), kInput, 0.25f), Error);
    }
  }
}

TEST(YoloOutput, ScoresBeyondOneAreAnError) {
  Output output({1, 3 * kCells, 7});
  output(9, 6) = 3.5f;
  EXPECT_THAT(Complaint(output), HasSubstr("a score is 3.5"));
}

TEST(YoloOutput, AShapeThatChangesIsAnError) {
  const YoloLayout layout = Recognise(Output({1, kCells, 7}));
  for (const auto& shape : {std::vector<int>{1, kCells, 6}, {1, kCells - 1, 7}, {7}, {1, 1, 1, 7}})
    EXPECT_THROW(DecodeYolo(layout, Output(shape).view(), kInput, 0.25f), Error);
}

}  // namespace
}  // namespace alidade::yolo_output_test
