// What the outputs of the YOLO family of networks mean, told by their shapes. A network of input
// W × H has one cell per 8 × 8, 16 × 16 and 32 × 32 pixels: (W/8·H/8 + W/16·H/16 + W/32·H/32) in
// all. Redmon et al. 2016 (YOLO), Ge et al. 2021 (YOLOX).
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/detect/detector.h"

namespace alidade {

// One output array, row after row.
struct NetworkOutput {
  std::vector<int> shape;
  std::span<const float> values;
};

enum class YoloFamily {
  kAnchors,     // YOLOv5, YOLOv7: [1, 3·cells, 5+C], boxes decoded
  kAnchorFree,  // YOLOX, YOLOv6: [1, cells, 5+C], YOLOX' with or without the boxes decoded
  kTransposed,  // YOLOv8, v9, 11: [1, 4+C, cells], boxes decoded, no objectness
  kSuppressed,  // YOLOv10, or others exported with suppression inside: [1, n, 6]
};

struct YoloLayout {
  YoloFamily family = YoloFamily::kAnchors;
  int output = 0;                // which of the outputs
  int classes = 0;               // 0: the shape doesn't say (kSuppressed)
  bool decoded = true;           // false: boxes are offsets from the cell and logarithms of sizes
  bool sure_of_objects = false;  // kAnchorFree: objectness is 1 everywhere, which is YOLOv6
};

// From the outputs for any one image. Throws Error (input) saying what was found when nothing fits,
// when values are not finite, or when scores are not between 0 and 1.
YoloLayout RecogniseYolo(std::span<const NetworkOutput> outputs, cv::Size input);

// The likeliest class of each cell that scores at least `min_score`; boxes in the input's pixels,
// clipped to it, in the network's order, things found more than once not yet suppressed.
// Throws Error (input) when the shape isn't that of `layout` or values are not finite.
std::vector<Detection> DecodeYolo(const YoloLayout& layout, const NetworkOutput& output,
                                  cv::Size input, float min_score);

}  // namespace alidade
