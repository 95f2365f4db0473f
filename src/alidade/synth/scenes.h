// The places there are, the way the camera takes through them, and where people may walk.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/synth/camera_path.h"
#include "alidade/synth/scene.h"

namespace alidade {

using Walk = std::vector<Eigen::Vector2d>;  // corners of a closed way over free floor, metres

// A part of a table over which things may be moved: the middle at the height they stand on, and
// half its size along the world's x and y.
struct TableTop {
  Eigen::Vector3d middle;  // metres
  double half_x = 0, half_y = 0;
  Eigen::Vector3d arm = {0.75, -0.55, 0.2};  // where an arm that reaches over it comes from
  double sitter = 0;  // metres along y to who sits at it; 0: nobody is in the picture
};

struct Layout {
  std::vector<PathKnot> knots;  // of the camera's way
  double period = 20;           // seconds once round it
  int turns = 0;                // of yaw meanwhile
  ShakeSettings shake;
  std::vector<Walk> walks;
  std::optional<TableTop> table;
};

// Fills the builder with the scene called `name`, one of SceneNames(); throws Error otherwise.
Layout LayOut(const std::string& name, SceneBuilder& builder);

Layout LayOutRoom(SceneBuilder& builder);      // once round a furnished room, looking across it
Layout LayOutDesk(SceneBuilder& builder);      // close above a cluttered desk
Layout LayOutCorridor(SceneBuilder& builder);  // out and back; doors and posters repeat
Layout LayOutWall(SceneBuilder& builder);      // along one wall that fills the view
Layout LayOutLoop(SceneBuilder& builder);      // through six rooms and back into the first
Layout LayOutStreet(SceneBuilder& builder);    // a car's way round a block of houses
Layout LayOutRoad(SceneBuilder& builder);      // a road through fields
Layout LayOutTable(SceneBuilder& builder);     // a bare table in a bare room
Layout LayOutBlank(SceneBuilder& builder);     // a turn in a room, past a wall that is blank
Layout LayOutHall(SceneBuilder& builder);      // past such a wall, and back past another

// The same place, where the camera turns or stands where its way begins (see SynthSettings::path).
Layout TurnOnTheSpot(Layout layout, double arm);
Layout StandStill(Layout layout);

// Knots at equal distances along a closed polygon, at one height; yaw looks along the way.
std::vector<PathKnot> KnotsAlong(const std::vector<Eigen::Vector2d>& corners, double height,
                                 int count);

}  // namespace alidade
