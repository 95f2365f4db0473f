#include "alidade/semidense/sensor_depth.h"

#include <cmath>

#include "alidade/features/depth_image.h"

namespace alidade {
namespace {

// Standard deviation of inverse depth, 1/m. Structured light measures a disparity: 1.5 mm at 1 m, 6
// mm at 2 m (Khoshelham & Elberink 2012).
constexpr float kSigma = 0.0015f;

}  // namespace

std::vector<Hypothesis> DepthFromSensor(const cv::Mat& depth, std::span<const EdgePixel> edges,
                                        const Camera& camera) {
  std::vector<Hypothesis> hypotheses(edges.size());
  if (depth.empty()) return hypotheses;
  const DepthImage image(depth, camera);
  for (size_t i = 0; i < edges.size(); ++i) {
    const Eigen::Vector2d raw = camera.Distort({edges[i].x, edges[i].y});
    const float z =
        image.At(static_cast<int>(std::lround(raw.x())), static_cast<int>(std::lround(raw.y())));
    if (z > 0) hypotheses[i] = {1 / z, kSigma};
  }
  return hypotheses;
}

}  // namespace alidade
