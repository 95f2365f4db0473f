#include "alidade/localize/part_errors.h"

#include <algorithm>
#include <array>
#include <vector>

#include "alidade/optimize/pose_only.h"

namespace alidade {
namespace {

constexpr int kColumns = 4, kRows = 3, kParts = kColumns * kRows;

int PartOf(const Camera& camera, double u, double v) {
  const int column = std::clamp(static_cast<int>(u / camera.width * kColumns), 0, kColumns - 1);
  const int row = std::clamp(static_cast<int>(v / camera.height * kRows), 0, kRows - 1);
  return row * kColumns + column;
}

}  // namespace

Matrix6d PartErrors(const PlacedFrame& placed, const Camera& camera, const MapSnapshot& map,
                    const MeasurementNoise& noise) {
  std::vector<PoseMatch> matches;
  std::vector<int> parts;
  std::array<int, kParts> counts{};
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const Landmark* landmark = placed.matches[i].valid() ? map.Find(placed.matches[i]) : nullptr;
    if (!landmark) continue;
    const Keypoint& keypoint = placed.frame->keypoints[i];
    const Measurement measured = Measure(keypoint, noise);
    matches.push_back({landmark->p_world, measured.pixel, measured.inv_sigma2,
                       measured.inv_sigma2_right, landmark->static_probability});
    parts.push_back(PartOf(camera, keypoint.x, keypoint.y));
    ++counts[static_cast<size_t>(parts.back())];
  }
  Matrix6d sum = Matrix6d::Zero();
  double count = 0;
  for (int part = 0; part < kParts; ++part) {
    if (counts[static_cast<size_t>(part)] == 0) continue;
    std::vector<PoseMatch> rest;
    rest.reserve(matches.size());
    for (size_t i = 0; i < matches.size(); ++i) {
      if (parts[i] != part) rest.push_back(matches[i]);
    }
    const Se3 T = OptimizePose(camera, placed.T_camera_world, rest).T_camera_world;
    const Vector6d moved = (T * placed.T_camera_world.Inverse()).Log();
    sum += moved * moved.transpose();
    ++count;
  }
  return count < 2 ? Matrix6d::Zero() : Matrix6d((count - 1) / count * sum);
}

}  // namespace alidade
