// Depth sensor readings as hypotheses, for comparison with depth from motion.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// One per edge pixel; unknown where the sensor has no reading. `depth`: see Picture.
std::vector<Hypothesis> DepthFromSensor(const cv::Mat& depth, std::span<const EdgePixel> edges,
                                        const Camera& camera);

}  // namespace alidade
