// The scenes: their layout, the camera's path, and where people may walk.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/synth/camera_path.h"
#include "alidade/synth/scene.h"

namespace alidade {

using Walk = std::vector<Eigen::Vector2d>;  // corners of a closed path over free floor, meters

// Part of a table over which objects are moved: its middle, at the height of the table top, and
// half of its size along the world's x and y.
struct TableTop {
  Eigen::Vector3d middle;  // meters
  double half_x = 0, half_y = 0;
  Eigen::Vector3d arm = {0.75, -0.55, 0.2};  // origin of an arm that reaches over the table
  double sitter = 0;                         // meters along y to a person sitting at it; 0: none
};

struct Layout {
  std::vector<PathKnot> knots;  // of the camera's path
  double period = 20;           // seconds once around
  int turns = 0;                // full turns of yaw per period
  ShakeSettings shake;
  std::vector<Walk> walks;
  std::optional<TableTop> table;
};

// Builds the scene `name` (one of SceneNames()); throws Error (usage) otherwise.
Layout LayOut(const std::string& name, SceneBuilder& builder);

Layout LayOutRoom(SceneBuilder& builder);      // once around a furnished room, looking across it
Layout LayOutDesk(SceneBuilder& builder);      // close above a cluttered desk
Layout LayOutCorridor(SceneBuilder& builder);  // out and back; doors and posters repeat
Layout LayOutWall(SceneBuilder& builder);      // along one wall that fills the view
Layout LayOutLoop(SceneBuilder& builder);      // through six rooms and back to the first
Layout LayOutStreet(SceneBuilder& builder);    // by car around a block of houses
Layout LayOutRoad(SceneBuilder& builder);      // a road through fields
Layout LayOutTable(SceneBuilder& builder);     // a bare table in a bare room
Layout LayOutBlank(SceneBuilder& builder);     // rotation in a room with one blank wall
Layout LayOutHall(SceneBuilder& builder);      // along such a wall, and back along another

// A hall around the positions `path` of a camera, 1.5 to 3 m beyond their extent. Returns the
// corner of the hall that is the scene's origin, in the coordinates of the path (z up), meters.
Eigen::Vector3d LayOutFlight(SceneBuilder& builder, std::vector<Eigen::Vector3d> path);

// The same scene with a camera that rotates or stands at the start of its path (see
// SynthSettings::path). `arm`: distance of the camera from the axis of rotation, meters.
Layout TurnOnTheSpot(Layout layout, double arm);
Layout StandStill(Layout layout);

// Knots at equal distances along a closed polygon at one height; yaw is along the path.
std::vector<PathKnot> KnotsAlong(const std::vector<Eigen::Vector2d>& corners, double height,
                                 int count);

}  // namespace alidade
