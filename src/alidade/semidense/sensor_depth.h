// A depth sensor's readings as hypotheses, to be held beside what motion tells.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

// One for each edge pixel; `depth`: as in Picture. Unknown where the sensor had no reading.
std::vector<Hypothesis> DepthFromSensor(const cv::Mat& depth, std::span<const EdgePixel> edges,
                                        const Camera& camera);

}  // namespace alidade
