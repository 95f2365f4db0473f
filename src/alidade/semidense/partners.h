// Which keyframes a keyframe's depth is found from, and what sets their pictures apart.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/semidense/gradient_image.h"

namespace alidade {

// The `count` covisible keyframes that share most landmarks, of those `usable`, with some baseline:
// in order of id.
std::vector<KeyFrameId> ChoosePartners(const MapSnapshot& map, const KeyFrame& keyframe, int count,
                                       const std::function<bool(KeyFrameId)>& usable);

struct Exposure {
  double gain = 1, offset = 0;  // intensity in the other = gain * intensity + offset
};

// By the intensities around landmarks both see; robust to what changes its look.
Exposure CompareExposures(const KeyFrame& reference, const GradientImage& reference_image,
                          const KeyFrame& other, const GradientImage& other_image);

// `values` of GradientImage as that exposure would have made them.
cv::Mat WithExposure(const cv::Mat& values, const Exposure& exposure);

}  // namespace alidade
