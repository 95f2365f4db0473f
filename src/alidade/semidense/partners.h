// Selection of the keyframes used for a keyframe's depth, and compensation of exposure differences.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/semidense/gradient_image.h"

namespace alidade {

// The `count` covisible keyframes accepted by `usable` that share the most landmarks and have a
// sufficient baseline; in order of ids.
std::vector<KeyFrameId> ChoosePartners(const MapSnapshot& map, const KeyFrame& keyframe, int count,
                                       const std::function<bool(KeyFrameId)>& usable);

struct Exposure {
  double gain = 1, offset = 0;  // intensity in the other image = gain * intensity + offset
};

// Robust estimate from the intensities around common landmarks.
Exposure CompareExposures(const KeyFrame& reference, const GradientImage& reference_image,
                          const KeyFrame& other, const GradientImage& other_image);

// Applies the exposure to GradientImage::values.
cv::Mat WithExposure(const cv::Mat& values, const Exposure& exposure);

}  // namespace alidade
