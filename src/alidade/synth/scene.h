// Scene of textured rectangles and quadrics with baked lighting.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/synth/texture.h"

namespace alidade {

// Brightness of a surface: a grid of factors over (u, v), bilinearly interpolated.
struct LightGrid {
  int columns = 1, rows = 1;                 // cells; values are at their corners
  std::vector<float> values = {1, 1, 1, 1};  // (columns + 1) × (rows + 1), row-major

  float At(float u, float v) const {
    const float x = u * static_cast<float>(columns), y = v * static_cast<float>(rows);
    int ix = static_cast<int>(x), iy = static_cast<int>(y);
    ix = ix < 0 ? 0 : (ix >= columns ? columns - 1 : ix);
    iy = iy < 0 ? 0 : (iy >= rows ? rows - 1 : iy);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const float* p = values.data() + static_cast<ptrdiff_t>(iy) * (columns + 1) + ix;
    const float* q = p + columns + 1;
    const float top = p[0] + fx * (p[1] - p[0]), bottom = q[0] + fx * (q[1] - q[0]);
    return top + fy * (bottom - top);
  }
};

// Rectangle of points origin + u * right + v * down with u, v in [0, 1]; right ⟂ down. Visible only
// from the side to which down × right points, where `right` and `down` appear as named.
struct Rect {
  Eigen::Vector3d origin, right, down;  // meters
  int texture = 0;
  LightGrid light;

  Eigen::Vector3d Normal() const { return down.cross(right).normalized(); }
};

// Unit ball or cone frustum in its own frame q = from_world * (p - origin). The frustum is the open
// lateral surface around z from z = 0 (radius 1) to z = 1 (radius `top`).
struct Quadric {
  enum class Kind { kBall, kFrustum };
  Kind kind = Kind::kBall;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d from_world = Eigen::Matrix3d::Identity();  // 1/meters
  double top = 1;
  double radius = 1;  // of a bounding sphere around `centre`, meters
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  // Circumference that the texture's width spans, meters.
  double size = 1;
  int texture = 0;
  float light = 1;  // factor where the surface faces up; less below
  bool actor = false;
};

// Box rotated about the vertical that casts soft shadows on nearby surfaces.
struct Obstacle {
  Eigen::Vector3d centre, half;  // meters
  double cos_yaw, sin_yaw;
  double Distance(const Eigen::Vector3d& p) const;  // meters; 0 inside
};

struct Scene {
  std::vector<Texture> textures;
  std::vector<Rect> rects;
  std::vector<Quadric> quadrics;
};

using Painter = std::function<cv::Mat(Random&)>;

// Assembles a scene. Textures are painted at the end, in parallel, each with its own random stream.
class SceneBuilder {
 public:
  explicit SceneBuilder(uint64_t seed) : seed_(seed), random_(seed, 11) {}

  Random& random() { return random_; }  // for layout
  int Paint(Painter painter);           // returns the index of the future texture
  int Tone(double grey);                // a texture of one gray level

  void Add(Rect rect) { scene_.rects.push_back(std::move(rect)); }
  void Add(Quadric quadric) { scene_.quadrics.push_back(quadric); }
  void AddObstacle(const Obstacle& obstacle) { obstacles_.push_back(obstacle); }
  void AddLamp(const Eigen::Vector3d& p) { lamps_.push_back(p); }

  Scene Build();

 private:
  double LightAt(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const;
  void BakeLight(Rect& rect) const;

  uint64_t seed_;
  Random random_;
  Scene scene_;
  std::vector<Painter> painters_;
  std::vector<Obstacle> obstacles_;
  std::vector<Eigen::Vector3d> lamps_;
  std::vector<std::pair<int, int>> tones_;  // gray level, texture index
};

}  // namespace alidade
