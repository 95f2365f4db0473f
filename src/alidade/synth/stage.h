// What may be seen from one pose, and in which tile of the picture: culling before rays are cast.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/synth/quadric_ray.h"
#include "alidade/synth/scene.h"

namespace alidade {

// From where the picture is taken, and the people in it. With a global shutter every row is the
// same.
struct Shutter {
  std::function<Se3(double row)> T_world_camera;
  std::function<std::vector<Quadric>(double row)> actors;
  bool rolling = false;  // rows differ
};

// A rectangle as intersection wants it: on the ray c + z R d, d = (x, y, 1), the place in the
// rectangle is u = fu·d / fw·d, v = fv·d / fw·d and 1 / z = fw·d, with linear forms that depend on
// the pose only.
struct RectForms {
  float fu[3], fv[3], fw[3];
};

// A rectangle's plane and its coordinates in the world: u = (p - origin)·u.
struct RectPlane {
  Eigen::Vector3d origin, normal, u, v;
  Eigen::Vector3d corners[4];
};
std::vector<RectPlane> PlanesOf(const std::vector<Rect>& rects);

// False when the pose is behind the rectangle.
bool MakeForms(const RectPlane& plane, const Se3& T_world_camera, RectForms& forms);

struct RayBounds {  // of x/z and y/z
  float left, right, top, bottom;
};

// Something that may be seen: a rectangle or a quadric.
struct StageItem {
  int surface = 0;    // index of the rectangle, or their number plus that of the quadric
  RectForms forms{};  // of a rectangle
  QuadricView view;   // of a quadric
  // Corners in the camera's frame, metres; of a quadric x, y, z [0] its centre, x[1] its radius.
  float x[4]{}, y[4]{}, z[4]{};
};

// Everything in front of the camera between two rows, seen from their middle's pose.
struct StageView {
  std::vector<StageItem> items;
  std::vector<Quadric> actors;
  Se3 T_world_camera;
  int rects = 0;     // of the scene
  float margin = 0;  // by how much x/z and y/z may differ from this pose's between those rows
};
StageView PrepareStage(const Scene& scene, const std::vector<RectPlane>& planes,
                       const Shutter& shutter, double first_row, double last_row, RayBounds bounds);

// A bound on 1/z within the tile, and the item; near ones first.
using TileList = std::vector<std::pair<float, int>>;
TileList ListTile(const StageView& stage, RayBounds tile);

}  // namespace alidade
