#include "alidade/detect/yolo_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/median.h"

namespace alidade {
namespace {

constexpr std::array<int, 3> kStrides = {8, 16, 32};
constexpr int kSuppressedRow = 6;     // left, top, right, bottom, score, class
constexpr float kScoreSlack = 1e-3f;  // half floats may round to more than 1

int Cells(cv::Size input, int stride) { return (input.width / stride) * (input.height / stride); }

int AllCells(cv::Size input) {
  int cells = 0;
  for (const int stride : kStrides) cells += Cells(input, stride);
  return cells;
}

std::string Text(const std::vector<int>& shape) {
  std::string text;
  for (const int side : shape) text += (text.empty() ? "" : ", ") + std::to_string(side);
  return "[" + text + "]";
}

std::string Known(cv::Size input) {
  const std::string cells = std::to_string(AllCells(input));
  return "for an input of " + std::to_string(input.width) + "x" + std::to_string(input.height) +
         " YOLOv5 and v7 give [1, " + std::to_string(3 * AllCells(input)) + ", 5+C], YOLOX [1, " +
         cells + ", 5+C], YOLOv8 and later [1, 4+C, " + cells + "] or [1, n, 6] (C classes)";
}

// Number of mask coefficients per box of a segmentation network, which has mask prototypes as a
// second output; 0 for a detector.
int MaskCoefficients(std::span<const NetworkOutput> outputs, cv::Size input) {
  for (const NetworkOutput& output : outputs) {
    if (output.shape.size() == 4 && output.shape[2] == input.height / 4 &&
        output.shape[3] == input.width / 4)
      return output.shape[1];
  }
  return 0;
}

std::optional<YoloLayout> LayoutOf(const std::vector<int>& shape, cv::Size input, int mask) {
  if (shape.size() != 3 || shape[0] != 1) return std::nullopt;
  const int cells = AllCells(input), cells_p6 = cells + Cells(input, 64);
  YoloLayout layout;
  const auto found = [&layout](YoloFamily family, int classes) -> std::optional<YoloLayout> {
    layout.family = family;
    layout.classes = classes;
    if (classes < 1) return std::nullopt;
    return layout;
  };
  if (shape[1] == 3 * cells || shape[1] == 3 * cells_p6)
    return found(YoloFamily::kAnchors, shape[2] - 5 - mask);
  if (shape[1] == cells) return found(YoloFamily::kAnchorFree, shape[2] - 5 - mask);
  if (shape[2] == cells) return found(YoloFamily::kTransposed, shape[1] - 4 - mask);
  if (shape[2] != kSuppressedRow) return std::nullopt;
  layout.family = YoloFamily::kSuppressed;
  return layout;
}

void RequireFinite(std::span<const float> values) {
  constexpr float kMost = std::numeric_limits<float>::max();
  if (!std::all_of(values.begin(), values.end(),
                   [](float value) { return std::abs(value) <= kMost; }))
    ThrowInput("the network gives values that are not finite");
}

// View of an output with one row per box, independent of the storage order.
struct Table {
  const float* values;
  int rows;
  size_t row_step, column_step;
  float operator()(int row, int column) const {
    return values[row * row_step + column * column_step];
  }
};

Table TableOf(const YoloLayout& layout, const NetworkOutput& output) {
  const auto columns = static_cast<size_t>(output.shape[2]);
  if (layout.family == YoloFamily::kTransposed)
    return {output.values.data(), output.shape[2], 1, columns};
  return {output.values.data(), output.shape[1], columns, 1};
}

// Columns that hold scores: [from, to).
std::array<int, 2> ScoreColumns(const YoloLayout& layout) {
  if (layout.family == YoloFamily::kSuppressed) return {4, 5};
  const int from = 4;
  return {from, from + layout.classes + (layout.family == YoloFamily::kTransposed ? 0 : 1)};
}

void RequireScores(const YoloLayout& layout, const Table& table) {
  const std::array<int, 2> columns = ScoreColumns(layout);
  for (int row = 0; row < table.rows; ++row) {
    for (int column = columns[0]; column < columns[1]; ++column) {
      const float score = table(row, column);
      if (score < -kScoreSlack || score > 1 + kScoreSlack) {
        ThrowInput("the network's outputs have the shape of a detector's, but a score is " +
                   std::to_string(score) +
                   ": it is not a detector, or was exported without its last layer (sigmoid)");
      }
    }
  }
}

// Calls visit(row, cell x, cell y, stride) for each row of an anchor-free output.
template <typename Visit>
void ForEachCell(cv::Size input, const Visit& visit) {
  int row = 0;
  for (const int stride : kStrides) {
    for (int y = 0; y < input.height / stride; ++y) {
      for (int x = 0; x < input.width / stride; ++x) visit(row++, x, y, stride);
    }
  }
}

// Detects whether box centers are decoded. Decoded centers lie within a few strides of their cells,
// offsets within a few units of zero; compares the medians of both distances.
bool CentresAreDecoded(const Table& table, cv::Size input) {
  std::vector<float> from_cell, from_zero;
  ForEachCell(input, [&](int row, int x, int y, int stride) {
    const auto s = static_cast<float>(stride);
    from_cell.push_back(std::abs(table(row, 0) / s - static_cast<float>(x) - 0.5f) +
                        std::abs(table(row, 1) / s - static_cast<float>(y) - 0.5f));
    from_zero.push_back(std::abs(table(row, 0) - 0.5f) + std::abs(table(row, 1) - 0.5f));
  });
  return UpperMedian(from_cell) < UpperMedian(from_zero);
}

// Box from its edges, clipped to the input.
cv::Rect2f Clipped(float left, float top, float right, float bottom, cv::Size input) {
  const auto width = static_cast<float>(input.width), height = static_cast<float>(input.height);
  left = std::clamp(left, 0.0f, width);
  top = std::clamp(top, 0.0f, height);
  return {left, top, std::clamp(right, left, width) - left, std::clamp(bottom, top, height) - top};
}

cv::Rect2f Around(float x, float y, float width, float height, cv::Size input) {
  return Clipped(x - width / 2, y - height / 2, x + width / 2, y + height / 2, input);
}

Detection Likeliest(const YoloLayout& layout, const Table& table, int row) {
  const bool objectness = layout.family != YoloFamily::kTransposed;
  const int first = objectness ? 5 : 4;
  Detection detection;
  for (int c = 0; c < layout.classes; ++c) {
    const float score = table(row, first + c);
    if (detection.class_id < 0 || score > detection.score) {
      detection.class_id = c;
      detection.score = score;
    }
  }
  if (objectness) detection.score *= table(row, 4);
  return detection;
}

std::vector<Detection> DecodeSuppressed(const Table& table, cv::Size input, float min_score) {
  std::vector<Detection> detections;
  for (int row = 0; row < table.rows; ++row) {
    if (!(table(row, 4) >= min_score)) continue;
    const float number = table(row, 5);
    if (!(number >= 0 && number < 65536))
      ThrowInput("the network gives a class " + std::to_string(number));
    Detection detection;
    detection.class_id = static_cast<int>(number);
    detection.score = std::min(table(row, 4), 1.0f);
    detection.box = Clipped(table(row, 0), table(row, 1), table(row, 2), table(row, 3), input);
    detections.push_back(detection);
  }
  return detections;
}

}  // namespace

YoloLayout RecogniseYolo(std::span<const NetworkOutput> outputs, cv::Size input) {
  const int mask = MaskCoefficients(outputs, input);
  std::string found;
  for (size_t i = 0; i < outputs.size(); ++i) {
    found += (i > 0 ? " and " : "") + Text(outputs[i].shape);
    std::optional<YoloLayout> layout = LayoutOf(outputs[i].shape, input, mask);
    if (!layout) continue;
    layout->output = static_cast<int>(i);
    RequireFinite(outputs[i].values);
    const Table table = TableOf(*layout, outputs[i]);
    RequireScores(*layout, table);
    if (layout->family == YoloFamily::kAnchorFree) {
      layout->decoded = CentresAreDecoded(table, input);
      layout->sure_of_objects = true;
      for (int row = 0; row < table.rows; ++row) layout->sure_of_objects &= table(row, 4) == 1;
    }
    return *layout;
  }
  ThrowInput("the outputs of the network are " + (found.empty() ? "none" : found) +
             ", which is not a known detector's: " + Known(input));
}

std::vector<Detection> DecodeYolo(const YoloLayout& layout, const NetworkOutput& output,
                                  cv::Size input, float min_score) {
  const int columns =
      layout.family == YoloFamily::kSuppressed ? kSuppressedRow : ScoreColumns(layout)[1];
  const bool transposed = layout.family == YoloFamily::kTransposed;
  if (output.shape.size() != 3 || output.shape[transposed ? 1 : 2] < columns ||
      output.values.size() !=
          static_cast<size_t>(output.shape[0]) * output.shape[1] * output.shape[2] ||
      (layout.family == YoloFamily::kAnchorFree && output.shape[1] != AllCells(input)))
    ThrowInput("the network's output changed its shape to " + Text(output.shape));
  RequireFinite(output.values);
  const Table table = TableOf(layout, output);
  if (layout.family == YoloFamily::kSuppressed) return DecodeSuppressed(table, input, min_score);

  std::vector<Detection> detections;
  const auto add = [&](int row, float x, float y, float width, float height) {
    Detection detection = Likeliest(layout, table, row);
    if (!(detection.score >= min_score)) return;
    detection.score = std::min(detection.score, 1.0f);
    detection.box = Around(x, y, width, height, input);
    detections.push_back(detection);
  };
  if (layout.decoded) {
    for (int row = 0; row < table.rows; ++row)
      add(row, table(row, 0), table(row, 1), table(row, 2), table(row, 3));
  } else {
    ForEachCell(input, [&](int row, int x, int y, int stride) {  // YOLOX, section 2.1
      const auto s = static_cast<float>(stride);
      add(row, (table(row, 0) + static_cast<float>(x)) * s,
          (table(row, 1) + static_cast<float>(y)) * s, std::exp(table(row, 2)) * s,
          std::exp(table(row, 3)) * s);
    });
  }
  return detections;
}

}  // namespace alidade
