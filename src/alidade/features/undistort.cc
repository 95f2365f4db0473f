#include "alidade/features/undistort.h"

namespace alidade {

void UndistortKeypoints(const Camera& camera, Frame& frame) {
  const bool distorted = camera.HasDistortion();
  for (Keypoint& k : frame.keypoints) {
    const Eigen::Vector2d raw(k.raw_x, k.raw_y);
    const Eigen::Vector2d ideal = distorted ? camera.Undistort(raw) : raw;
    k.x = static_cast<float>(ideal.x());
    k.y = static_cast<float>(ideal.y());
  }
  frame.grid = KeypointGrid(frame.keypoints, camera.width, camera.height);
}

}  // namespace alidade
