// Projects a place to the page and draws its elements.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// T_world_camera; one list per uninterrupted stretch.
using DrawnPath = std::vector<std::vector<Se3>>;

enum class PlaceView {
  kAbove,  // the first camera's forward direction is up on the page
  // Up is up; the horizontal axis is right or forward, whichever has the larger extent of the path.
  kSide,
};

// Maps world coordinates to the page. Fits all of the path into the drawing, and the landmarks
// except for distant outliers.
class PlacePage {
 public:
  // `upright`: the path from which forward is taken, and up is estimated unless `gravity` is known.
  PlacePage(const std::vector<DrawnPath>& paths, const std::vector<Eigen::Vector3d>& landmarks,
            const DrawnPath& upright, PlaceView view,
            const std::optional<Eigen::Vector3d>& gravity = {});

  double height() const { return height_; }
  double scale() const { return scale_; }  // pixels per unit
  Eigen::Vector2d At(const Eigen::Vector3d& p) const;

  // SVG elements; `name`: the CSS class.
  std::string Lines(const DrawnPath& path, const std::string& name) const;
  std::string Dots(const std::vector<Eigen::Vector3d>& points, const std::string& name) const;
  std::string Marker(const Eigen::Vector3d& p, const std::string& name) const;
  std::string ScaleBar(const std::string& unit) const;  // about an eighth of the drawing's width

 private:
  Eigen::Matrix<double, 2, 3> axes_;
  Eigen::Vector2d low_, high_;
  double height_, scale_ = 1;
};

}  // namespace alidade
