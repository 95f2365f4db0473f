// What a frame says of a landmark: as log-odds of standing still, to be added up.
#pragma once

#include <Eigen/Core>

#include "alidade/dynamics/belief_settings.h"
#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/frame_belief.h"

namespace alidade {

// What there is where a landmark should be seen.
enum class Sight {
  kClear,    // nothing against seeing it
  kHidden,   // something moving is in front of it, or may be
  kOnMover,  // it is at the depth of what moves there
  kGone      // one sees through its place to what is behind
};

// `p`: the landmark in the camera's frame, at depth z. With t = DepthTolerance(z), of the nine
// cells around where it should be seen: kClear when one within t of z is believed to stand still,
// kOnMover when one is that moves, kGone when all that have depth are beyond z + free_tolerances t,
// kHidden otherwise.
Sight SightOf(const Cells& cells, const FrameBelief& belief, const Eigen::Vector3d& p,
              const LandmarkEvidenceSettings& settings = {},
              const CellDepthSettings& depth_settings = {});

inline float EvidenceOf(Sight sight, bool found, const LandmarkEvidenceSettings& settings = {}) {
  switch (sight) {
    case Sight::kOnMover:
      return settings.on_mover;
    case Sight::kGone:
      return found ? 0.0f : settings.gone;
    case Sight::kHidden:
      return found ? settings.hidden_found : 0.0f;
    case Sight::kClear:
      return found ? settings.found : 0.0f;
  }
  return 0;
}

}  // namespace alidade
