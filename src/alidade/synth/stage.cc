#include "alidade/synth/stage.h"

#include <algorithm>
#include <cmath>

namespace alidade {

using Eigen::Vector3d;

namespace {

constexpr float kNear = 0.01f;  // near plane, meters

// True if the convex hull of the corners may intersect the rays' bounds.
bool Touches(const StageItem& item, const RayBounds& bounds) {
  // True if all corners are on that side.
  bool left = true, right = true, top = true, bottom = true, behind = true;
  for (int i = 0; i < 4; ++i) {
    left = left && item.x[i] < bounds.left * item.z[i];
    right = right && item.x[i] > bounds.right * item.z[i];
    top = top && item.y[i] < bounds.top * item.z[i];
    bottom = bottom && item.y[i] > bounds.bottom * item.z[i];
    behind = behind && item.z[i] < kNear;
  }
  return !(left || right || top || bottom || behind);
}

bool BallTouches(const StageItem& item, const RayBounds& bounds) {
  const float x = item.x[0], y = item.y[0], z = item.z[0], radius = item.x[1];
  if (z + radius < kNear) return false;
  const auto inside = [radius](float offset, float slope) {
    return offset > -radius * std::sqrt(1 + slope * slope);
  };
  return inside(x - bounds.left * z, bounds.left) && inside(bounds.right * z - x, bounds.right) &&
         inside(y - bounds.top * z, bounds.top) && inside(bounds.bottom * z - y, bounds.bottom);
}

RayBounds Widened(const RayBounds& bounds, float by) {
  return {bounds.left - by, bounds.right + by, bounds.top - by, bounds.bottom + by};
}

// Bound on the deviation of rays between two rows. Nothing is nearer than 0.3 m, so a translation
// by s moves rays by at most s / 0.3.
float Margin(const Shutter& shutter, const Se3& pose, double first_row, double last_row) {
  double margin = 0;
  for (const double row : {first_row, last_row}) {
    const Se3 other = shutter.T_world_camera(row);
    margin = std::max(margin, 2 * RotationAngle(pose, other) + (other.t - pose.t).norm() / 0.3);
  }
  return static_cast<float>(1.5 * margin);
}

}  // namespace

std::vector<RectPlane> PlanesOf(const std::vector<Rect>& rects) {
  std::vector<RectPlane> planes;
  for (const Rect& rect : rects) {
    RectPlane plane;
    plane.origin = rect.origin;
    plane.normal = rect.Normal();
    plane.u = rect.right / rect.right.squaredNorm();
    plane.v = rect.down / rect.down.squaredNorm();
    for (int i = 0; i < 4; ++i)
      plane.corners[i] = rect.origin + (i & 1) * rect.right + (i >> 1) * rect.down;
    planes.push_back(plane);
  }
  return planes;
}

bool MakeForms(const RectPlane& plane, const Se3& T_world_camera, RectForms& forms) {
  const Vector3d from = T_world_camera.t - plane.origin;
  const double height = plane.normal.dot(from);
  if (height <= 1e-6) return false;
  const Eigen::Matrix3d& R = T_world_camera.R;
  const Vector3d w = -R.transpose() * plane.normal / height;
  const Vector3d u = R.transpose() * plane.u + w * from.dot(plane.u),
                 v = R.transpose() * plane.v + w * from.dot(plane.v);
  for (int i = 0; i < 3; ++i) {
    forms.fu[i] = static_cast<float>(u[i]);
    forms.fv[i] = static_cast<float>(v[i]);
    forms.fw[i] = static_cast<float>(w[i]);
  }
  return true;
}

StageView PrepareStage(const Scene& scene, const std::vector<RectPlane>& planes,
                       const Shutter& shutter, double first_row, double last_row,
                       RayBounds bounds) {
  StageView stage;
  const double middle = (first_row + last_row) / 2;
  stage.T_world_camera = shutter.T_world_camera(middle);
  stage.actors = shutter.actors(middle);
  stage.rects = static_cast<int>(planes.size());
  if (shutter.rolling) stage.margin = Margin(shutter, stage.T_world_camera, first_row, last_row);
  bounds = Widened(bounds, stage.margin);
  const Se3 T_camera_world = stage.T_world_camera.Inverse();

  StageItem item;
  const auto place = [&item](int i, const Vector3d& p) {
    item.x[i] = static_cast<float>(p.x());
    item.y[i] = static_cast<float>(p.y());
    item.z[i] = static_cast<float>(p.z());
  };
  for (int i = 0; i < stage.rects; ++i) {
    const RectPlane& plane = planes[i];
    const bool facing = MakeForms(plane, stage.T_world_camera, item.forms);
    // Other rows may see the front of a rectangle whose back faces this pose.
    const bool may_face =
        shutter.rolling && plane.normal.dot(stage.T_world_camera.t - plane.origin) > -0.05;
    if (!facing && !may_face) continue;
    for (int corner = 0; corner < 4; ++corner)
      place(corner, T_camera_world * plane.corners[corner]);
    item.surface = i;
    if (Touches(item, bounds)) stage.items.push_back(item);
  }
  const int fixed = static_cast<int>(scene.quadrics.size());
  for (int i = 0; i < fixed + static_cast<int>(stage.actors.size()); ++i) {
    const Quadric& quadric = i < fixed ? scene.quadrics[i] : stage.actors[i - fixed];
    place(0, T_camera_world * quadric.centre);
    item.x[1] = static_cast<float>(quadric.radius);
    item.surface = stage.rects + i;
    item.view = SeenFrom(quadric, stage.T_world_camera.R, stage.T_world_camera.t);
    if (BallTouches(item, bounds)) stage.items.push_back(item);
  }
  return stage;
}

TileList ListTile(const StageView& stage, RayBounds tile) {
  const RayBounds b = Widened(tile, stage.margin);
  TileList list;
  for (size_t i = 0; i < stage.items.size(); ++i) {
    const StageItem& item = stage.items[i];
    const bool rect = item.surface < stage.rects;
    if (!(rect ? Touches(item, b) : BallTouches(item, b))) continue;
    const float nearest =
        rect ? std::min(std::min(item.z[0], item.z[1]), std::min(item.z[2], item.z[3]))
             : item.z[0] - item.x[1];
    float bound = nearest > kNear ? 1 / nearest : 1 / kNear;
    if (rect && stage.margin == 0) {  // 1/z is linear over the rays
      const float* f = item.forms.fw;
      const float steepest =
          f[2] + std::max(f[0] * b.left, f[0] * b.right) + std::max(f[1] * b.top, f[1] * b.bottom);
      if (steepest <= 0) continue;
      bound = std::min(bound, steepest);
    }
    list.emplace_back(1.001f * bound, static_cast<int>(i));
  }
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& c) {
    return a.first != c.first ? a.first > c.first : a.second < c.second;
  });
  return list;
}

}  // namespace alidade
