// Expected screen positions, by an independent projection, compared with the lit pixels.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "alidade/gles/view.h"
#include "gles/gl_screen.h"

namespace alidade::gles_test {

// Projection from the upper left corner of a screen filled by the map: f * x / z right of the
// center.
struct Lens {
  Lens(const gles::ViewSettings& view, int width_, int height_)
      : T_eye_world(view.T_world_eye.Inverse()),
        width(width_),
        height(height_),
        f(height_ / 2.0 / std::tan(view.fov / 2)),
        nearest(view.nearest) {}
  // nullopt: behind the eye or outside the screen.
  std::optional<Eigen::Vector2d> See(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector3d p = T_eye_world * p_world;
    if (p.z() <= nearest) return std::nullopt;
    const Eigen::Vector2d at(width / 2.0 + f * p.x() / p.z(), height / 2.0 + f * p.y() / p.z());
    if (at.x() < 0 || at.y() < 0 || at.x() >= width || at.y() >= height) return std::nullopt;
    return at;
  }
  Se3 T_eye_world;
  int width, height;
  double f, nearest;
};

inline bool IsLit(const Shot& shot, int x, int y, const gles::ViewSettings& view) {
  return shot.Has(x, y) && Difference(shot.At(x, y), PixelOf(view.colors.background)) > 1;
}
inline int CountLit(const Shot& shot, const gles::ViewSettings& view) {
  int lit = 0;
  for (int y = 0; y < shot.height; ++y)
    for (int x = 0; x < shot.width; ++x) lit += IsLit(shot, x, y, view);
  return lit;
}

// Checks that exactly the points are drawn, with one pixel each. A point near a pixel's edge may be
// in the adjacent pixel, because the GPU computes with 24 bits.
inline void ExpectPoints(const Shot& shot, const gles::ViewSettings& view,
                         const std::vector<Eigen::Vector3d>& points) {
  constexpr double kEdge = 0.02;  // pixels
  const Lens lens(view, shot.width, shot.height);
  std::vector<uint8_t> may(shot.pixels.size(), 0);
  int seen = 0, missed = 0;
  for (const Eigen::Vector3d& p : points) {
    const auto at = lens.See(p);
    if (!at) continue;
    ++seen;
    bool lit = false;
    for (double dx : {-kEdge, kEdge}) {
      for (double dy : {-kEdge, kEdge}) {
        const auto x = static_cast<int>(std::floor(at->x() + dx));
        const auto y = static_cast<int>(std::floor(at->y() + dy));
        if (!shot.Has(x, y)) {
          lit = true;  // at the edge of the screen
          continue;
        }
        may[static_cast<size_t>(y) * static_cast<size_t>(shot.width) + static_cast<size_t>(x)] = 1;
        lit = lit || IsLit(shot, x, y, view);
      }
    }
    missed += !lit;
  }
  EXPECT_GT(seen, 0) << "a test that looks away";
  EXPECT_EQ(missed, 0) << "of " << seen;
  int stray = 0;
  for (int y = 0; y < shot.height; ++y) {
    for (int x = 0; x < shot.width; ++x) {
      stray +=
          IsLit(shot, x, y, view) &&
          !may[static_cast<size_t>(y) * static_cast<size_t>(shot.width) + static_cast<size_t>(x)];
    }
  }
  EXPECT_EQ(stray, 0);
}

// Checks that exactly the segments are drawn, with the given width. All must be in front of the
// eye.
struct Segment {
  Eigen::Vector3d from, to;
};
inline void ExpectSegments(const Shot& shot, const gles::ViewSettings& view,
                           const std::vector<Segment>& segments) {
  const Lens lens(view, shot.width, shot.height);
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines;
  int dark = 0;
  for (const Segment& segment : segments) {
    const auto a = lens.See(segment.from), b = lens.See(segment.to);
    ASSERT_TRUE(a && b) << "a test that looks away";
    lines.emplace_back(*a, *b);
    const double length = (*b - *a).norm();
    // Ends may be clipped within a pixel.
    for (double along = 1; along < length - 1; along += 1.5) {
      const Eigen::Vector2d at = *a + along / length * (*b - *a);
      dark += !IsLit(shot, static_cast<int>(at.x()), static_cast<int>(at.y()), view);
    }
  }
  EXPECT_EQ(dark, 0);
  const auto distance = [](const Eigen::Vector2d& p, const auto& line) {
    const Eigen::Vector2d d = line.second - line.first;
    const double along =
        std::clamp((p - line.first).dot(d) / std::max(d.squaredNorm(), 1e-12), 0.0, 1.0);
    return (p - line.first - along * d).norm();
  };
  int stray = 0;
  for (int y = 0; y < shot.height; ++y) {
    for (int x = 0; x < shot.width; ++x) {
      if (!IsLit(shot, x, y, view)) continue;
      stray += std::none_of(lines.begin(), lines.end(), [&](const auto& line) {
        return distance({x + 0.5, y + 0.5}, line) < view.line_width / 2 + 0.75;
      });
    }
  }
  EXPECT_EQ(stray, 0);
}

}  // namespace alidade::gles_test
