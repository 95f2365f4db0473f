#include "alidade/synth/scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "alidade/base/parallel.h"

namespace alidade {

double Obstacle::Distance(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d d = p - centre;
  const Eigen::Vector3d local(cos_yaw * d.x() + sin_yaw * d.y(), -sin_yaw * d.x() + cos_yaw * d.y(),
                              d.z());
  return (local.cwiseAbs() - half).cwiseMax(0).norm();
}

int SceneBuilder::Paint(Painter painter) {
  painters_.push_back(std::move(painter));
  return static_cast<int>(painters_.size()) - 1;
}

int SceneBuilder::Tone(double grey) {
  const int level = static_cast<int>(std::lround(grey));
  for (const auto& [known, texture] : tones_) {
    if (known == level) return texture;
  }
  const int texture = Paint([level](Random&) { return cv::Mat(1, 1, CV_8U, cv::Scalar(level)); });
  tones_.emplace_back(level, texture);
  return texture;
}

// Diffuse light: ambient light with occlusion by corners and nearby objects (distance-field
// occlusion, Evans 2006), plus lamps with smooth fall-off and no shadows.
double SceneBuilder::LightAt(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const {
  double occlusion = 0;
  double weight = 1;
  for (double step = 0.08; step < 0.8; step *= 2, weight *= 0.6) {
    const Eigen::Vector3d probe = p + step * normal;
    double distance = step;
    for (const Obstacle& obstacle : obstacles_)
      distance = std::min(distance, obstacle.Distance(probe));
    occlusion += weight * (step - distance) / step;
  }
  const double ambient = 0.62 * std::max(0.35, 1 - 0.32 * occlusion);
  double direct = 0;
  for (const Eigen::Vector3d& lamp : lamps_) {
    const Eigen::Vector3d to = lamp - p;
    const double d2 = to.squaredNorm();
    const double cosine = std::max(0.0, to.dot(normal) / std::sqrt(d2));
    direct += (0.25 + 0.75 * cosine) / (1 + d2 / 4);
  }
  return ambient + 0.6 * std::min(1.0, direct);
}

void SceneBuilder::BakeLight(Rect& rect) const {
  constexpr double kCell = 0.2;  // meters
  LightGrid& light = rect.light;
  light.columns = std::clamp(static_cast<int>(std::lround(rect.right.norm() / kCell)), 1, 64);
  light.rows = std::clamp(static_cast<int>(std::lround(rect.down.norm() / kCell)), 1, 64);
  light.values.clear();
  const Eigen::Vector3d normal = rect.Normal();
  for (int y = 0; y <= light.rows; ++y) {
    for (int x = 0; x <= light.columns; ++x) {
      const Eigen::Vector3d p = rect.origin +
                                rect.right * (static_cast<double>(x) / light.columns) +
                                rect.down * (static_cast<double>(y) / light.rows);
      light.values.push_back(static_cast<float>(LightAt(p, normal)));
    }
  }
}

Scene SceneBuilder::Build() {
  const int count = static_cast<int>(painters_.size());
  std::vector<std::optional<Texture>> painted(count);
  ParallelFor(count, [&](int i) {
    Random random(seed_, 1000 + static_cast<uint64_t>(i));
    painted[i].emplace(painters_[i](random));
  });
  scene_.textures.clear();
  for (auto& texture : painted) scene_.textures.push_back(std::move(*texture));
  ParallelFor(static_cast<int>(scene_.rects.size()), [&](int i) { BakeLight(scene_.rects[i]); });
  ParallelFor(static_cast<int>(scene_.quadrics.size()), [&](int i) {
    Quadric& quadric = scene_.quadrics[i];
    quadric.light = static_cast<float>(LightAt(quadric.centre, Eigen::Vector3d::UnitZ()));
  });
  return std::move(scene_);
}

}  // namespace alidade
