// Detects the layout of the outputs of YOLO networks from their shapes, and decodes them. A network
// with input W × H has one cell per 8 × 8, 16 × 16 and 32 × 32 pixels: W/8·H/8 + W/16·H/16 +
// W/32·H/32 cells. Redmon et al. 2016 (YOLO), Ge et al. 2021 (YOLOX).
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/detect/detector.h"

namespace alidade {

// One output array, row-major.
struct NetworkOutput {
  std::vector<int> shape;
  std::span<const float> values;
};

enum class YoloFamily {
  kAnchors,     // YOLOv5, YOLOv7: [1, 3·cells, 5+C], boxes decoded
  kAnchorFree,  // YOLOX, YOLOv6: [1, cells, 5+C]; YOLOX's boxes may be decoded or not
  kTransposed,  // YOLOv8, v9, 11: [1, 4+C, cells], boxes decoded, no objectness
  kSuppressed,  // YOLOv10, and networks exported with non-maximum suppression: [1, n, 6]
};

struct YoloLayout {
  YoloFamily family = YoloFamily::kAnchors;
  int output = 0;                // index of the output
  int classes = 0;               // 0: not stated by the shape (kSuppressed)
  bool decoded = true;           // false: boxes are offsets from the cell and logarithms of sizes
  bool sure_of_objects = false;  // kAnchorFree: objectness is 1 everywhere, which identifies YOLOv6
};

// Detects the layout from the outputs for any one image. Throws Error (input) when no layout
// matches, a value is not finite, or a score is not between 0 and 1.
YoloLayout RecogniseYolo(std::span<const NetworkOutput> outputs, cv::Size input);

// Returns the most likely class of each cell with a score of at least `min_score`; boxes in pixels
// of the input, clipped to it; in the network's order, before non-maximum suppression. Throws Error
// (input) when the shape does not match `layout` or a value is not finite.
std::vector<Detection> DecodeYolo(const YoloLayout& layout, const NetworkOutput& output,
                                  cv::Size input, float min_score);

}  // namespace alidade
