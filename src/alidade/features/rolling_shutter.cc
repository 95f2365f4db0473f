#include "alidade/features/rolling_shutter.h"

namespace alidade {
namespace {

// Smallest z of a corrected direction (1 before the correction). Below it the motion is
// implausible, and the keypoint is not corrected.
constexpr double kLeastForward = 0.1;

}  // namespace

void UndoRollingShutter(const Camera& camera, const Vector6d& motion,
                        std::span<const float> inverse_depths, double common, Frame& frame) {
  frame.motion = motion;
  if (!camera.RollingShutter()) return;
  const bool distorted = camera.HasDistortion();
  for (size_t i = 0; i < frame.keypoints.size(); ++i) {
    Keypoint& k = frame.keypoints[i];
    const Eigen::Vector2d raw(k.raw_x, k.raw_y);
    const Eigen::Vector2d ideal = distorted ? camera.Undistort(raw) : raw;
    const Se3 back = Se3::Exp(-camera.ReadAfterMiddle(k.raw_x, k.raw_y) * motion);
    const bool known = i < inverse_depths.size() && inverse_depths[i] > 0;
    const double inverse_depth = known ? inverse_depths[i] : common;
    const Eigen::Vector3d p = back.R * camera.Unproject(ideal) + inverse_depth * back.t;
    if (!(p.z() > kLeastForward)) continue;
    const Eigen::Vector2d pixel = camera.Project(p);
    // The correction shifts the observation in the right image by the same amount.
    if (k.has_depth()) k.right_x += static_cast<float>(pixel.x()) - k.x;
    k.x = static_cast<float>(pixel.x());
    k.y = static_cast<float>(pixel.y());
  }
  frame.grid = KeypointGrid(frame.keypoints, camera.width, camera.height);
}

}  // namespace alidade
