#include "alidade/dynamics/landmark_belief.h"

#include <cmath>

#include "alidade/dynamics/evidence.h"

namespace alidade {

Sight SightOf(const Cells& cells, const FrameBelief& belief, const Eigen::Vector3d& p,
              const LandmarkEvidenceSettings& settings, const CellDepthSettings& depth_settings) {
  const std::vector<float>& depth = belief.depth;
  const std::vector<float>& log_odds = belief.log_odds;
  const int cell = cells.Project(p);
  if (cell < 0) return Sight::kClear;
  if (depth.empty()) return log_odds[cell] < 0 ? Sight::kHidden : Sight::kClear;
  const auto z = static_cast<float>(p.z());
  const float tolerance = DepthTolerance(z, depth_settings);
  int known = 0, behind = 0;
  bool still = false, mover = false;
  cells.VisitAround(cell, 1, [&](int n) {
    if (!(depth[n] > 0)) return;
    ++known;
    behind += depth[n] > z + depth_settings.free_tolerances * tolerance;
    if (std::abs(depth[n] - z) > tolerance) return;
    (log_odds[n] < 0 ? mover : still) = true;
  });
  if (still || known < settings.min_neighbours) return Sight::kClear;
  if (mover) return Sight::kOnMover;
  return behind == known ? Sight::kGone : Sight::kHidden;
}

}  // namespace alidade
