// Evidence that a frame gives about a landmark, as log-odds of being static that are summed over
// frames.
#pragma once

#include <Eigen/Core>

#include "alidade/dynamics/belief_settings.h"
#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/frame_belief.h"

namespace alidade {

// What the frame shows where a landmark should appear.
enum class Sight {
  kClear,    // nothing contradicts seeing the landmark
  kHidden,   // occluded by a moving object, or possibly so
  kOnMover,  // at the depth of a moving object
  kGone      // the frame sees through the landmark's position to a surface behind it
};

// `p`: the landmark in the camera's frame, at depth z. With t = DepthTolerance(z), considers the
// nine cells around its projection. kClear: the landmark is outside the image, or fewer than
// min_neighbours cells have depth, or a static cell is within t of z. Otherwise kOnMover: a moving
// cell is within t of z; kGone: all cells with depth are beyond z + free_tolerances t; else
// kHidden. Without depth: kHidden on a moving cell, else kClear.
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
