// How a place is laid on the page, and what is marked there.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// T_world_camera; one list for each stretch without a gap.
using DrawnPath = std::vector<std::vector<Se3>>;

enum class PlaceView {
  kAbove,  // where the first camera looked is up on the page
  kSide,   // up is up; to the right is right or forward, whichever the path goes along further
};

// From world to page; fits what matters of the place into the picture: all of the path, and the
// landmarks but for the few that lie far off.
class PlacePage {
 public:
  // `upright`: the path that says which way is up and forward.
  PlacePage(const std::vector<DrawnPath>& paths, const std::vector<Eigen::Vector3d>& landmarks,
            const DrawnPath& upright, PlaceView view);

  double height() const { return height_; }
  double scale() const { return scale_; }  // pixels per unit
  Eigen::Vector2d At(const Eigen::Vector3d& p) const;

  // As SVG elements; `name`: the CSS class.
  std::string Lines(const DrawnPath& path, const std::string& name) const;
  std::string Dots(const std::vector<Eigen::Vector3d>& points, const std::string& name) const;
  std::string Marker(const Eigen::Vector3d& p, const std::string& name) const;
  std::string ScaleBar(const std::string& unit) const;  // about an eighth of the picture long

 private:
  Eigen::Matrix<double, 2, 3> axes_;
  Eigen::Vector2d low_, high_;
  double height_, scale_ = 1;
};

}  // namespace alidade
