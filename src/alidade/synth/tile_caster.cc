#include "alidade/synth/tile_caster.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>

namespace alidade {
namespace {

constexpr float kSky = 230;       // gray level of the background
constexpr float kSharpen = 0.2f;  // mip levels finer than the pixel width

// log2 with an error of about 0.01: exponent plus a parabola in the mantissa.
float FastLog2(float x) {
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffu) | 0x3f800000u);
  return static_cast<float>(static_cast<int>(bits >> 23) - 128) +
         (-0.33582878f * mantissa + 2.0f) * mantissa - 0.65871759f;
}

float Apply(const float form[3], float x, float y) { return form[0] * x + form[1] * y + form[2]; }

// Four rays, processed in parallel.
struct RayGroup {
  cv::v_float32x4 x, y, best;
  cv::v_int32x4 found;
};
constexpr int kGroups = TileCaster::kTile / 4;

void MeetRect(const RectForms& f, int which, RayGroup groups[kGroups]) {
  using cv::v_float32x4;
  const v_float32x4 zero = cv::v_setall_f32(0);
  const v_float32x4 w0 = cv::v_setall_f32(f.fw[0]), w1 = cv::v_setall_f32(f.fw[1]),
                    w2 = cv::v_setall_f32(f.fw[2]);
  const v_float32x4 u0 = cv::v_setall_f32(f.fu[0]), u1 = cv::v_setall_f32(f.fu[1]),
                    u2 = cv::v_setall_f32(f.fu[2]);
  const v_float32x4 v0 = cv::v_setall_f32(f.fv[0]), v1 = cv::v_setall_f32(f.fv[1]),
                    v2 = cv::v_setall_f32(f.fv[2]);
  const cv::v_int32x4 me = cv::v_setall_s32(which);
  for (int g = 0; g < kGroups; ++g) {
    RayGroup& group = groups[g];
    const v_float32x4 w = w0 * group.x + w1 * group.y + w2;
    const v_float32x4 u = u0 * group.x + u1 * group.y + u2;
    const v_float32x4 v = v0 * group.x + v1 * group.y + v2;
    const v_float32x4 hit = (w > group.best) & (u >= zero) & (v >= zero) & (u <= w) & (v <= w);
    group.best = cv::v_select(hit, w, group.best);
    group.found = cv::v_select(cv::v_reinterpret_as_s32(hit), me, group.found);
  }
}

void MeetRound(const Quadric& quadric, const QuadricView& view, int which, const float* ray_x,
               const float* ray_y, RayGroup groups[kGroups]) {
  for (int g = 0; g < kGroups; ++g) {
    float near[4];
    int found[4];
    cv::v_store(near, groups[g].best);
    cv::v_store(found, groups[g].found);
    for (int k = 0; k < 4; ++k) {
      const double z = MeetQuadric(quadric, view, ray_x[4 * g + k], ray_y[4 * g + k]);
      if (z > 0 && static_cast<float>(1 / z) > near[k]) {
        near[k] = static_cast<float>(1 / z);
        found[k] = which;
      }
    }
    groups[g].best = cv::v_load(near);
    groups[g].found = cv::v_load(found);
  }
}

}  // namespace

TileCaster::TileCaster(const Scene& scene, const std::vector<RectPlane>& planes,
                       const Camera& camera, const Shutter& shutter, const StageView& stage,
                       const TileList& list)
    : scene_(scene),
      planes_(planes),
      camera_(camera),
      shutter_(shutter),
      stage_(stage),
      list_(list) {
  for (const auto& entry : list) {
    const StageItem& item = stage.items[entry.second];
    is_rect_.push_back(item.surface < stage.rects);
    forms_.push_back(item.forms);
    views_.push_back(item.view);
  }
}

void TileCaster::SetRow(int row) {
  if (!shutter_.rolling) return;
  const Se3 pose = shutter_.T_world_camera(row);
  for (size_t i = 0; i < list_.size(); ++i) {
    if (is_rect_[i]) {
      const RectPlane& plane = planes_[Surface(static_cast<int>(i))];
      if (!MakeForms(plane, pose, forms_[i]))
        forms_[i] = {{0, 0, -1}, {0, 0, -1}, {0, 0, -1}};  // never intersected
    } else {
      views_[i] = SeenFrom(QuadricOf(static_cast<int>(i)), pose.R, pose.t);
    }
  }
}

int TileCaster::Surface(int which) const {
  return which < 0 ? -1 : stage_.items[list_[which].second].surface;
}

bool TileCaster::IsActor(int which) const {
  return which >= 0 && !is_rect_[which] && QuadricOf(which).actor;
}

const Quadric& TileCaster::QuadricOf(int which) const {
  const int index = Surface(which) - stage_.rects, fixed = static_cast<int>(scene_.quadrics.size());
  return index < fixed ? scene_.quadrics[index] : stage_.actors[index - fixed];
}

void TileCaster::Row(const float* ray_x, const float* ray_y, float* inverse_z, int* which) const {
  RayGroup groups[kGroups];
  for (int g = 0; g < kGroups; ++g) {
    groups[g] = {cv::v_load(ray_x + 4 * g), cv::v_load(ray_y + 4 * g), cv::v_setall_f32(0),
                 cv::v_setall_s32(-1)};
  }
  const int count = static_cast<int>(list_.size());
  for (int i = 0; i < count; ++i) {
    if (i % 4 == 0) {  // stop if all further items are behind the hits so far
      const cv::v_float32x4 farthest = cv::v_min(cv::v_min(groups[0].best, groups[1].best),
                                                 cv::v_min(groups[2].best, groups[3].best));
      if (cv::v_reduce_min(farthest) > list_[i].first) break;
    }
    if (is_rect_[i]) {
      MeetRect(forms_[i], i, groups);
    } else {
      MeetRound(QuadricOf(i), views_[i], i, ray_x, ray_y, groups);
    }
  }
  for (int g = 0; g < kGroups; ++g) {
    cv::v_store(inverse_z + 4 * g, groups[g].best);
    cv::v_store(which + 4 * g, groups[g].found);
  }
}

int TileCaster::Cast(float x, float y) const {
  float nearest = 0;  // 1/z
  int which = -1;
  const int count = static_cast<int>(list_.size());
  for (int i = 0; i < count && nearest <= list_[i].first; ++i) {
    if (is_rect_[i]) {
      const RectForms& f = forms_[i];
      const float w = Apply(f.fw, x, y);
      if (!(w > nearest)) continue;
      const float u = Apply(f.fu, x, y), v = Apply(f.fv, x, y);
      if (!(u >= 0 && v >= 0 && u <= w && v <= w)) continue;
      nearest = w;
      which = i;
    } else {
      const double z = MeetQuadric(QuadricOf(i), views_[i], x, y);
      if (!(z > 0 && static_cast<float>(1 / z) > nearest)) continue;
      nearest = static_cast<float>(1 / z);
      which = i;
    }
  }
  return which;
}

bool TileCaster::Meets(int which, float x, float y) const {
  return which < 0 || is_rect_[which] || MeetQuadric(QuadricOf(which), views_[which], x, y) > 0;
}

float TileCaster::Shade(int which, float x, float y) const {
  if (which < 0) return kSky;
  return is_rect_[which] ? ShadeRect(which, x, y) : ShadeRound(which, x, y);
}

float TileCaster::ShadeRect(int which, float x, float y) const {
  const Rect& rect = scene_.rects[Surface(which)];
  const Texture& texture = scene_.textures[rect.texture];
  const RectForms& f = forms_[which];
  const float inverse = 1 / Apply(f.fw, x, y);
  const float u = Apply(f.fu, x, y) * inverse, v = Apply(f.fv, x, y) * inverse;
  const float light = rect.light.At(u, v);
  const float width = static_cast<float>(texture.width()),
              height = static_cast<float>(texture.height());
  if (width == 1 && height == 1) return light * texture.Sample(0.5f, 0.5f, 0);
  // Texture coordinate steps per pixel to the right and down.
  const float sx = inverse / static_cast<float>(camera_.fx),
              sy = inverse / static_cast<float>(camera_.fy);
  const float ux = (f.fu[0] - u * f.fw[0]) * sx, vx = (f.fv[0] - v * f.fw[0]) * sx;
  const float uy = (f.fu[1] - u * f.fw[1]) * sy, vy = (f.fv[1] - v * f.fw[1]) * sy;
  const float along_x = ux * ux * width * width + vx * vx * height * height;
  const float along_y = uy * uy * width * width + vy * vy * height * height;
  const bool x_longer = along_x > along_y;
  const float longer2 = std::max(x_longer ? along_x : along_y, 1e-12f);
  const float area = std::abs(ux * vy - uy * vx) * width * height;
  // Anisotropic filtering: at oblique views a pixel covers a long strip, sampled several times
  // along it.
  const float ratio = longer2 / std::max(area, 1e-6f);
  const int samples = ratio < 1.5f ? 1 : (ratio < 3 ? 2 : (ratio < 5.5f ? 4 : 6));
  const float lod = 0.5f * FastLog2(longer2 / static_cast<float>(samples * samples)) - kSharpen;
  const float du = x_longer ? ux : uy, dv = x_longer ? vx : vy;
  float sum = 0;
  for (int i = 0; i < samples; ++i) {
    const float off = (static_cast<float>(i) + 0.5f) / static_cast<float>(samples) - 0.5f;
    sum += texture.Sample(u + off * du, v + off * dv, lod);
  }
  return light * sum / static_cast<float>(samples);
}

float TileCaster::ShadeRound(int which, float x, float y) const {
  const Quadric& quadric = QuadricOf(which);
  const QuadricHit hit = ShadeQuadric(quadric, views_[which], x, y);
  const Texture& texture = scene_.textures[quadric.texture];
  const double texels = hit.z / camera_.fx * texture.width() / quadric.size;
  const float lod = FastLog2(static_cast<float>(std::max(texels * 1.3, 1e-6))) - kSharpen;
  return hit.light * texture.Sample(hit.u, hit.v, lod);
}

}  // namespace alidade
