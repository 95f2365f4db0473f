// What a frame says of a landmark: as log-odds of standing still, to be added up.
#pragma once

#include <Eigen/Core>

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

// `p`: the landmark in the camera's frame.
Sight SightOf(const Cells& cells, const FrameBelief& belief, const Eigen::Vector3d& p);

inline float EvidenceOf(Sight sight, bool found) {
  switch (sight) {
    case Sight::kOnMover:
      return -0.4f;
    case Sight::kGone:
      return found ? 0.0f : -0.7f;
    case Sight::kHidden:
      return found ? -0.3f : 0.0f;
    case Sight::kClear:
      return found ? 0.15f : 0.0f;
  }
  return 0;
}

}  // namespace alidade
