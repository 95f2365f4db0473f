// The places there are, the way the camera takes through them, and where people may walk.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/synth/camera_path.h"
#include "alidade/synth/scene.h"

namespace alidade {

using Walk = std::vector<Eigen::Vector2d>;  // corners of a closed way over free floor, metres

struct Layout {
  std::vector<PathKnot> knots;  // of the camera's way
  double period = 20;           // seconds once round it
  int turns = 0;                // of yaw meanwhile
  ShakeSettings shake;
  std::vector<Walk> walks;
};

// Fills the builder with the scene called `name`, one of SceneNames(); throws Error otherwise.
Layout LayOut(const std::string& name, SceneBuilder& builder);

Layout LayOutRoom(SceneBuilder& builder);      // once round a furnished room, looking across it
Layout LayOutDesk(SceneBuilder& builder);      // close above a cluttered desk
Layout LayOutCorridor(SceneBuilder& builder);  // out and back; doors and posters repeat
Layout LayOutWall(SceneBuilder& builder);      // along one wall that fills the view
Layout LayOutLoop(SceneBuilder& builder);      // through six rooms and back into the first

// Knots at equal distances along a closed polygon, at one height; yaw looks along the way.
std::vector<PathKnot> KnotsAlong(const std::vector<Eigen::Vector2d>& corners, double height,
                                 int count);

}  // namespace alidade
