#include "alidade/synth/renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>

#include "alidade/base/parallel.h"
#include "alidade/synth/quadric_ray.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr float kSky = 230;  // grey level where there is nothing

// log2 to about 0.01: the exponent, and a parabola through the mantissa.
float FastLog2(float x) {
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffu) | 0x3f800000u);
  return static_cast<float>(static_cast<int>(bits >> 23) - 128) +
         (-0.33582878f * mantissa + 2.0f) * mantissa - 0.65871759f;
}

}  // namespace

// Something that may be seen in a stage: a rectangle or a quadric.
struct ViewRenderer::Item {
  int surface = 0;               // index of the rectangle, or their number plus that of the quadric
  RectForms forms{};             // rectangles
  float x[4]{}, y[4]{}, z[4]{};  // corners in the camera's frame, metres; of a quadric x, y, z [0]
                                 // its centre, x[1] its radius
  QuadricView view;              // quadrics
};

// Everything in front of the camera between two rows, from one pose.
struct ViewRenderer::Stage {
  std::vector<Item> items;
  std::vector<Quadric> actors;
  Matrix3d R;  // of T_world_camera
  Vector3d t;
  float margin = 0;  // by how much rays (x/z, y/z) may differ from this pose's between those rows
};

struct ViewRenderer::TileList {
  std::vector<std::pair<float, int>> near_first;  // bound on 1/z, item of the stage
};

namespace {

bool FormsFrom(const Vector3d& origin, const Vector3d& normal, const Vector3d& u, const Vector3d& v,
               const Matrix3d& R, const Vector3d& t, RectForms& forms) {
  const Vector3d from = t - origin;
  const double height = normal.dot(from);
  if (height <= 1e-6) return false;  // seen from behind
  const Vector3d w = -R.transpose() * normal / height;
  const Vector3d fu = R.transpose() * u + w * from.dot(u), fv = R.transpose() * v + w * from.dot(v);
  for (int i = 0; i < 3; ++i) {
    forms.fu[i] = static_cast<float>(fu[i]);
    forms.fv[i] = static_cast<float>(fv[i]);
    forms.fw[i] = static_cast<float>(w[i]);
  }
  return true;
}

float Apply(const float form[3], float x, float y) { return form[0] * x + form[1] * y + form[2]; }

}  // namespace

ViewRenderer::ViewRenderer(const Scene& scene, const Camera& camera)
    : scene_(scene), camera_(camera) {
  columns_ = (camera.width + kTile - 1) / kTile;
  rows_ = (camera.height + kTile - 1) / kTile;
  ray_x_.create(rows_ * kTile + 1, columns_ * kTile + 1);
  ray_y_.create(ray_x_.size());
  ParallelFor(ray_x_.rows, [&](int y) {
    for (int x = 0; x < ray_x_.cols; ++x) {
      const Eigen::Vector2d pixel(std::min(x, camera.width), std::min(y, camera.height));
      const Vector3d ray = camera_.Unproject(camera_.Undistort(pixel));
      ray_x_(y, x) = static_cast<float>(ray.x());
      ray_y_(y, x) = static_cast<float>(ray.y());
    }
  });
  for (const Rect& rect : scene.rects) {
    Plane plane;
    plane.origin = rect.origin;
    plane.normal = rect.Normal();
    plane.u = rect.right / rect.right.squaredNorm();
    plane.v = rect.down / rect.down.squaredNorm();
    for (int i = 0; i < 4; ++i)
      plane.corners[i] = rect.origin + (i & 1) * rect.right + (i >> 1) * rect.down;
    planes_.push_back(plane);
  }
}

ViewRenderer::Bounds ViewRenderer::TileBounds(int column, int row) const {
  const cv::Rect area(column * kTile, row * kTile, kTile + 1, kTile + 1);
  double left, right, top, bottom;
  cv::minMaxLoc(ray_x_(area), &left, &right);
  cv::minMaxLoc(ray_y_(area), &top, &bottom);
  // Samples lie up to half a pixel around the rays.
  const double half = 0.6 / std::min(camera_.fx, camera_.fy);
  return {static_cast<float>(left - half), static_cast<float>(right + half),
          static_cast<float>(top - half), static_cast<float>(bottom + half)};
}

namespace {

// Whether some of a convex set of corners may lie within the rays' bounds.
bool Touches(const float x[4], const float y[4], const float z[4], float left, float right,
             float top, float bottom) {
  bool out_left = true, out_right = true, out_top = true, out_bottom = true, behind = true;
  for (int i = 0; i < 4; ++i) {
    out_left = out_left && x[i] < left * z[i];
    out_right = out_right && x[i] > right * z[i];
    out_top = out_top && y[i] < top * z[i];
    out_bottom = out_bottom && y[i] > bottom * z[i];
    behind = behind && z[i] < 0.01f;
  }
  return !(out_left || out_right || out_top || out_bottom || behind);
}

bool BallTouches(float x, float y, float z, float radius, float left, float right, float top,
                 float bottom) {
  if (z + radius < 0.01f) return false;
  const auto inside = [radius](float offset, float slope) {
    return offset > -radius * std::sqrt(1 + slope * slope);
  };
  return inside(x - left * z, left) && inside(right * z - x, right) && inside(y - top * z, top) &&
         inside(bottom * z - y, bottom);
}

}  // namespace

ViewRenderer::Stage ViewRenderer::PrepareStage(const Shutter& shutter, double first_row,
                                               double last_row) const {
  Stage stage;
  const double middle = (first_row + last_row) / 2;
  const Se3 pose = shutter.T_world_camera(middle);
  stage.R = pose.R;
  stage.t = pose.t;
  stage.actors = shutter.actors(middle);
  if (shutter.rolling) {
    // Nothing is nearer than 0.3 m: a shift by s moves rays by s / 0.3 at most.
    for (const double row : {first_row, last_row}) {
      const Se3 other = shutter.T_world_camera(row);
      const double reach = 2 * RotationAngle(pose, other) + (other.t - pose.t).norm() / 0.3;
      stage.margin = std::max(stage.margin, static_cast<float>(1.5 * reach));
    }
  }
  Bounds all = {1e9f, -1e9f, 1e9f, -1e9f};
  const int first = std::clamp(static_cast<int>(first_row), 0, ray_x_.rows - 1);
  const int last = std::clamp(static_cast<int>(last_row) + 1, first + 1, ray_x_.rows);
  double low, high;
  cv::minMaxLoc(ray_x_.rowRange(first, last), &low, &high);
  const float half = static_cast<float>(0.6 / std::min(camera_.fx, camera_.fy)) + stage.margin;
  all.left = static_cast<float>(low) - half;
  all.right = static_cast<float>(high) + half;
  cv::minMaxLoc(ray_y_.rowRange(first, last), &low, &high);
  all.top = static_cast<float>(low) - half;
  all.bottom = static_cast<float>(high) + half;

  Item item;
  for (size_t i = 0; i < planes_.size(); ++i) {
    const Plane& plane = planes_[i];
    const bool facing =
        FormsFrom(plane.origin, plane.normal, plane.u, plane.v, stage.R, stage.t, item.forms);
    if (!facing && !(shutter.rolling && plane.normal.dot(stage.t - plane.origin) > -0.05)) continue;
    for (int corner = 0; corner < 4; ++corner) {
      const Vector3d p = stage.R.transpose() * (plane.corners[corner] - stage.t);
      item.x[corner] = static_cast<float>(p.x());
      item.y[corner] = static_cast<float>(p.y());
      item.z[corner] = static_cast<float>(p.z());
    }
    if (!Touches(item.x, item.y, item.z, all.left, all.right, all.top, all.bottom)) continue;
    item.surface = static_cast<int>(i);
    stage.items.push_back(item);
  }
  const int rects = static_cast<int>(planes_.size()),
            fixed = static_cast<int>(scene_.quadrics.size());
  for (int i = 0; i < fixed + static_cast<int>(stage.actors.size()); ++i) {
    const Quadric& quadric = i < fixed ? scene_.quadrics[i] : stage.actors[i - fixed];
    const Vector3d p = stage.R.transpose() * (quadric.centre - stage.t);
    item.x[0] = static_cast<float>(p.x());
    item.y[0] = static_cast<float>(p.y());
    item.z[0] = static_cast<float>(p.z());
    item.x[1] = static_cast<float>(quadric.radius);
    if (!BallTouches(item.x[0], item.y[0], item.z[0], item.x[1], all.left, all.right, all.top,
                     all.bottom))
      continue;
    item.view = SeenFrom(quadric, stage.R, stage.t);
    item.surface = rects + i;
    stage.items.push_back(item);
  }
  return stage;
}

ViewRenderer::TileList ViewRenderer::ListTile(const Stage& stage, const Bounds& tile) const {
  const Bounds b = {tile.left - stage.margin, tile.right + stage.margin, tile.top - stage.margin,
                    tile.bottom + stage.margin};
  const int rects = static_cast<int>(planes_.size());
  TileList list;
  for (size_t i = 0; i < stage.items.size(); ++i) {
    const Item& item = stage.items[i];
    float bound;  // of 1/z within the tile
    if (item.surface < rects) {
      if (!Touches(item.x, item.y, item.z, b.left, b.right, b.top, b.bottom)) continue;
      const float nearest =
          std::min(std::min(item.z[0], item.z[1]), std::min(item.z[2], item.z[3]));
      bound = nearest > 0.01f ? 1 / nearest : 100;
      if (stage.margin == 0) {  // 1/z is linear over the rays
        const float* f = item.forms.fw;
        const float steepest = f[2] + std::max(f[0] * b.left, f[0] * b.right) +
                               std::max(f[1] * b.top, f[1] * b.bottom);
        if (steepest <= 0) continue;
        bound = std::min(bound, steepest);
      }
    } else {
      if (!BallTouches(item.x[0], item.y[0], item.z[0], item.x[1], b.left, b.right, b.top,
                       b.bottom))
        continue;
      const float nearest = item.z[0] - item.x[1];
      bound = nearest > 0.01f ? 1 / nearest : 100;
    }
    list.near_first.emplace_back(1.001f * bound, static_cast<int>(i));
  }
  std::sort(list.near_first.begin(), list.near_first.end(), [](const auto& a, const auto& b2) {
    return a.first != b2.first ? a.first > b2.first : a.second < b2.second;
  });
  return list;
}

// Casts the rays of one tile against its list.
class ViewRenderer::TileCaster {
 public:
  TileCaster(const ViewRenderer& renderer, const Shutter& shutter, const Stage& stage,
             const TileList& list)
      : r_(renderer),
        shutter_(shutter),
        stage_(stage),
        list_(list),
        rects_(static_cast<int>(renderer.planes_.size())) {
    if (!shutter.rolling) {
      for (const auto& [bound, index] : list.near_first) Load(index, stage.R, stage.t, false);
    }
  }

  // To be called before a row's rays are cast.
  void SetRow(int row) {
    if (!shutter_.rolling) return;
    const Se3 pose = shutter_.T_world_camera(row);
    forms_.clear();
    views_.clear();
    for (const auto& [bound, index] : list_.near_first) Load(index, pose.R, pose.t, true);
  }

  // 1/z and place in the list (-1: nothing) of what the row's rays meet first, kTile of them.
  void Row(const float* ray_x, const float* ray_y, float* inverse_z, int* which) const {
    using cv::v_float32x4;
    constexpr int kGroups = kTile / 4;
    v_float32x4 x[kGroups], y[kGroups], best[kGroups];
    cv::v_int32x4 found[kGroups];
    for (int g = 0; g < kGroups; ++g) {
      x[g] = cv::v_load(ray_x + 4 * g);
      y[g] = cv::v_load(ray_y + 4 * g);
      best[g] = cv::v_setall_f32(0);
      found[g] = cv::v_setall_s32(-1);
    }
    const v_float32x4 zero = cv::v_setall_f32(0);
    const int count = static_cast<int>(list_.near_first.size());
    for (int i = 0; i < count; ++i) {
      if (i % 4 == 0) {  // what follows lies behind all that was met?
        const v_float32x4 farthest =
            cv::v_min(cv::v_min(best[0], best[1]), cv::v_min(best[2], best[3]));
        if (cv::v_reduce_min(farthest) > list_.near_first[i].first) break;
      }
      if (!is_rect_[i]) {
        RowQuadric(i, ray_x, ray_y, best, found);
        continue;
      }
      const RectForms& f = forms_[i];
      const v_float32x4 w0 = cv::v_setall_f32(f.fw[0]), w1 = cv::v_setall_f32(f.fw[1]),
                        w2 = cv::v_setall_f32(f.fw[2]);
      const v_float32x4 u0 = cv::v_setall_f32(f.fu[0]), u1 = cv::v_setall_f32(f.fu[1]),
                        u2 = cv::v_setall_f32(f.fu[2]);
      const v_float32x4 v0 = cv::v_setall_f32(f.fv[0]), v1 = cv::v_setall_f32(f.fv[1]),
                        v2 = cv::v_setall_f32(f.fv[2]);
      const cv::v_int32x4 me = cv::v_setall_s32(i);
      for (int g = 0; g < kGroups; ++g) {
        const v_float32x4 w = w0 * x[g] + w1 * y[g] + w2;
        const v_float32x4 u = u0 * x[g] + u1 * y[g] + u2;
        const v_float32x4 v = v0 * x[g] + v1 * y[g] + v2;
        const v_float32x4 hit = (w > best[g]) & (u >= zero) & (v >= zero) & (u <= w) & (v <= w);
        best[g] = cv::v_select(hit, w, best[g]);
        found[g] = cv::v_select(cv::v_reinterpret_as_s32(hit), me, found[g]);
      }
    }
    for (int g = 0; g < kGroups; ++g) {
      cv::v_store(inverse_z + 4 * g, best[g]);
      cv::v_store(which + 4 * g, found[g]);
    }
  }

  // One ray.
  int Cast(float x, float y, float& inverse_z) const {
    inverse_z = 0;
    int which = -1;
    const int count = static_cast<int>(list_.near_first.size());
    for (int i = 0; i < count; ++i) {
      if (inverse_z > list_.near_first[i].first) break;
      if (!is_rect_[i]) {
        const double z = MeetQuadric(TheQuadric(i), views_[i], x, y);
        if (z > 0 && static_cast<float>(1 / z) > inverse_z) {
          inverse_z = static_cast<float>(1 / z);
          which = i;
        }
        continue;
      }
      const RectForms& f = forms_[i];
      const float w = Apply(f.fw, x, y);
      if (!(w > inverse_z)) continue;
      const float u = Apply(f.fu, x, y), v = Apply(f.fv, x, y);
      if (u >= 0 && v >= 0 && u <= w && v <= w) {
        inverse_z = w;
        which = i;
      }
    }
    return which;
  }

  // Grey level where the ray meets the list's `which`; `sharpen`: levels of detail finer than a
  // pixel's.
  float Shade(int which, float x, float y, float sharpen) const {
    if (which < 0) return kSky;
    const int surface = Surface(which);
    if (surface >= rects_) return ShadeRound(which, x, y, sharpen);
    const Rect& rect = r_.scene_.rects[surface];
    const Texture& texture = r_.scene_.textures[rect.texture];
    const RectForms& f = forms_[which];
    const float inverse = 1 / Apply(f.fw, x, y);
    const float u = Apply(f.fu, x, y) * inverse, v = Apply(f.fv, x, y) * inverse;
    const float light = rect.light.At(u, v);
    const float width = static_cast<float>(texture.width()),
                height = static_cast<float>(texture.height());
    if (width == 1 && height == 1) return light * texture.Sample(0.5f, 0.5f, 0);
    // Steps in the texture for one pixel to the right and one down.
    const float sx = inverse / static_cast<float>(r_.camera_.fx),
                sy = inverse / static_cast<float>(r_.camera_.fy);
    const float ux = (f.fu[0] - u * f.fw[0]) * sx, vx = (f.fv[0] - v * f.fw[0]) * sx;
    const float uy = (f.fu[1] - u * f.fw[1]) * sy, vy = (f.fv[1] - v * f.fw[1]) * sy;
    const float along_x = ux * ux * width * width + vx * vx * height * height;
    const float along_y = uy * uy * width * width + vy * vy * height * height;
    const bool x_longer = along_x > along_y;
    const float longer2 = std::max(x_longer ? along_x : along_y, 1e-12f);
    const float area = std::abs(ux * vy - uy * vx) * width * height;
    // Seen aslant, a pixel covers a long strip: several samples along it.
    const float ratio = longer2 / std::max(area, 1e-6f);
    const int samples = ratio < 1.5f ? 1 : (ratio < 3 ? 2 : (ratio < 5.5f ? 4 : 6));
    const float lod = 0.5f * FastLog2(longer2 / static_cast<float>(samples * samples)) - sharpen;
    const float du = x_longer ? ux : uy, dv = x_longer ? vx : vy;
    float sum = 0;
    for (int i = 0; i < samples; ++i) {
      const float off = (static_cast<float>(i) + 0.5f) / static_cast<float>(samples) - 0.5f;
      sum += texture.Sample(u + off * du, v + off * dv, lod);
    }
    return light * sum / static_cast<float>(samples);
  }

  int Surface(int which) const {
    return which < 0 ? -1 : stage_.items[list_.near_first[which].second].surface;
  }
  bool IsActor(int which) const {
    return which >= 0 && !is_rect_[which] && TheQuadric(which).actor;
  }

 private:
  void Load(int index, const Matrix3d& R, const Vector3d& t, bool again) {
    const Item& item = stage_.items[index];
    const bool rect = item.surface < rects_;
    if (is_rect_.size() < list_.near_first.size()) is_rect_.push_back(rect);
    RectForms forms = item.forms;
    QuadricView view = item.view;
    if (again && rect) {
      const Plane& plane = r_.planes_[item.surface];
      if (!FormsFrom(plane.origin, plane.normal, plane.u, plane.v, R, t, forms))
        forms = {{0, 0, -1}, {0, 0, -1}, {0, 0, -1}};
    } else if (again) {
      view = SeenFrom(QuadricOf(item), R, t);
    }
    forms_.push_back(forms);
    views_.push_back(view);
  }
  const Quadric& QuadricOf(const Item& item) const {
    const int index = item.surface - rects_, fixed = static_cast<int>(r_.scene_.quadrics.size());
    return index < fixed ? r_.scene_.quadrics[index] : stage_.actors[index - fixed];
  }
  const Quadric& TheQuadric(int which) const {
    return QuadricOf(stage_.items[list_.near_first[which].second]);
  }

  void RowQuadric(int i, const float* ray_x, const float* ray_y, cv::v_float32x4* best,
                  cv::v_int32x4* found) const {
    float near[kTile];
    int who[kTile];
    for (int g = 0; g < kTile / 4; ++g) {
      cv::v_store(near + 4 * g, best[g]);
      cv::v_store(who + 4 * g, found[g]);
    }
    const Quadric& quadric = TheQuadric(i);
    for (int k = 0; k < kTile; ++k) {
      const double z = MeetQuadric(quadric, views_[i], ray_x[k], ray_y[k]);
      if (z > 0 && static_cast<float>(1 / z) > near[k]) {
        near[k] = static_cast<float>(1 / z);
        who[k] = i;
      }
    }
    for (int g = 0; g < kTile / 4; ++g) {
      best[g] = cv::v_load(near + 4 * g);
      found[g] = cv::v_load(who + 4 * g);
    }
  }

  float ShadeRound(int which, float x, float y, float sharpen) const {
    const Quadric& quadric = TheQuadric(which);
    const QuadricHit hit = ShadeQuadric(quadric, views_[which], x, y);
    const Texture& texture = r_.scene_.textures[quadric.texture];
    const double texels = hit.z / r_.camera_.fx * texture.width() / quadric.size;
    const float lod = FastLog2(static_cast<float>(std::max(texels * 1.3, 1e-6))) - sharpen;
    return hit.light * texture.Sample(hit.u, hit.v, lod);
  }

  const ViewRenderer& r_;
  const Shutter& shutter_;
  const Stage& stage_;
  const TileList& list_;
  int rects_;
  std::vector<char> is_rect_;
  std::vector<RectForms> forms_;    // one for each of the list, for the row set
  std::vector<QuadricView> views_;  // likewise
};

View ViewRenderer::Render(const Shutter& shutter) const {
  const int width = camera_.width, height = camera_.height;
  View view;
  view.grey.create(height, width);
  view.depth.create(height, width);
  view.actor.create(height, width);
  cv::Mat1i surfaces(height, width);
  std::vector<Stage> stages(shutter.rolling ? rows_ : 1);
  ParallelFor(static_cast<int>(stages.size()), [&](int i) {
    stages[i] = shutter.rolling
                    ? PrepareStage(shutter, i * kTile, std::min((i + 1) * kTile, height))
                    : PrepareStage(shutter, 0, height);
  });
  const auto stage_of = [&](int band) -> const Stage& {
    return stages[shutter.rolling ? band : 0];
  };
  std::vector<TileList> lists(static_cast<size_t>(columns_) * rows_);

  ParallelFor(rows_, [&](int band) {
    for (int column = 0; column < columns_; ++column) {
      TileList& list = lists[static_cast<size_t>(band) * columns_ + column];
      list = ListTile(stage_of(band), TileBounds(column, band));
      TileCaster caster(*this, shutter, stage_of(band), list);
      float inverse_z[kTile];
      int which[kTile];
      const int left = column * kTile, right = std::min(left + kTile, width);
      for (int y = band * kTile; y < std::min((band + 1) * kTile, height); ++y) {
        caster.SetRow(y);
        const float* ray_x = ray_x_[y] + left;
        const float* ray_y = ray_y_[y] + left;
        caster.Row(ray_x, ray_y, inverse_z, which);
        for (int x = left; x < right; ++x) {
          const int k = x - left;
          view.grey(y, x) = caster.Shade(which[k], ray_x[k], ray_y[k], 0.2f);
          view.depth(y, x) = which[k] < 0 ? 0 : 1 / inverse_z[k];
          view.actor(y, x) = caster.IsActor(which[k]) ? 255 : 0;
          surfaces(y, x) = caster.Surface(which[k]);
        }
      }
    }
  });

  // Pixels astride the outlines of surfaces gather from all they touch.
  const cv::Mat1f one_sample = view.grey.clone();
  constexpr int kSamples = 8;
  constexpr float kOffsets[kSamples][2] = {{1, -3}, {-1, 3},  {5, 1}, {-3, -5},
                                           {-5, 5}, {-7, -1}, {3, 7}, {7, -7}};  // 1/16 pixel
  ParallelFor(rows_, [&](int band) {
    for (int column = 0; column < columns_; ++column) {
      const TileList& list = lists[static_cast<size_t>(band) * columns_ + column];
      TileCaster caster(*this, shutter, stage_of(band), list);
      const int left = column * kTile, right = std::min(left + kTile, width);
      for (int y = band * kTile; y < std::min((band + 1) * kTile, height); ++y) {
        bool row_set = false;
        for (int x = left; x < right; ++x) {
          const int surface = surfaces(y, x);
          const float grey = one_sample(y, x);
          const auto differs = [&](int y2, int x2) {
            return y2 >= 0 && y2 < height && x2 >= 0 && x2 < width && surfaces(y2, x2) != surface &&
                   std::abs(one_sample(y2, x2) - grey) > 1.5f;
          };
          if (!differs(y, x - 1) && !differs(y, x + 1) && !differs(y - 1, x) && !differs(y + 1, x))
            continue;
          if (!row_set) caster.SetRow(y);
          row_set = true;
          const float px = ray_x_(y, x), py = ray_y_(y, x);
          const float right_x = ray_x_(y, x + 1) - px, right_y = ray_y_(y, x + 1) - py;
          const float down_x = ray_x_(y + 1, x) - px, down_y = ray_y_(y + 1, x) - py;
          float sum = 0;
          for (const auto& offset : kOffsets) {
            const float a = offset[0] / 16, b = offset[1] / 16;
            const float sx = px + a * right_x + b * down_x, sy = py + a * right_y + b * down_y;
            float inverse_z;
            const int which = caster.Cast(sx, sy, inverse_z);
            sum += caster.Shade(which, sx, sy, 0.7f);
          }
          view.grey(y, x) = sum / kSamples;
        }
      }
    }
  });
  return view;
}

}  // namespace alidade
