// Visibility culling for one pose, before rays are cast: which objects may be visible in which
// tile.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/synth/quadric_ray.h"
#include "alidade/synth/scene.h"

namespace alidade {

// Camera pose and actors by image row; constant for a global shutter.
struct Shutter {
  std::function<Se3(double row)> T_world_camera;
  std::function<std::vector<Quadric>(double row)> actors;
  bool rolling = false;  // rolling shutter: rows differ
};

// A rectangle in the form used for intersection. On the ray c + z R d with d = (x, y, 1), the
// texture coordinates are u = fu·d / fw·d, v = fv·d / fw·d, and 1 / z = fw·d. The linear forms
// depend on the pose only.
struct RectForms {
  float fu[3], fv[3], fw[3];
};

// Plane of a rectangle with coordinates in the world frame: u = (p - origin)·u.
struct RectPlane {
  Eigen::Vector3d origin, normal, u, v;
  Eigen::Vector3d corners[4];
};
std::vector<RectPlane> PlanesOf(const std::vector<Rect>& rects);

// Returns false if the pose is behind the rectangle.
bool MakeForms(const RectPlane& plane, const Se3& T_world_camera, RectForms& forms);

struct RayBounds {  // of x/z and y/z
  float left, right, top, bottom;
};

// A possibly visible rectangle or quadric.
struct StageItem {
  int surface = 0;    // index of the rectangle, or number of rectangles + index of the quadric
  RectForms forms{};  // of a rectangle
  QuadricView view;   // of a quadric
  // Corners in the camera frame, meters. For a quadric: x, y, z [0] its center, x[1] its radius.
  float x[4]{}, y[4]{}, z[4]{};
};

// Objects in front of the camera for a range of rows, as seen from the pose of the middle row.
struct StageView {
  std::vector<StageItem> items;
  std::vector<Quadric> actors;
  Se3 T_world_camera;
  int rects = 0;  // number of rectangles of the scene
  // Bound on the change of x/z and y/z relative to this pose within the range of rows.
  float margin = 0;
};
StageView PrepareStage(const Scene& scene, const std::vector<RectPlane>& planes,
                       const Shutter& shutter, double first_row, double last_row, RayBounds bounds);

// Upper bound of 1/z within the tile, and item index; nearest first.
using TileList = std::vector<std::pair<float, int>>;
TileList ListTile(const StageView& stage, RayBounds tile);

}  // namespace alidade
