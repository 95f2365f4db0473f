#include "alidade/gles/view.h"

#include <cmath>
#include <string>

#include "alidade/base/error.h"

namespace alidade::gles {

void ViewSettings::Check() const {
  const auto need = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("the view's ") + what);
  };
  need(fov > 0 && fov < 3.1, "fov must lie between 0 and 3.1 radians");
  need(nearest > 0 && std::isfinite(nearest), "nearest must be above 0");
  need(T_world_eye.t.allFinite() && T_world_eye.R.allFinite(), "eye is no pose");
  need(other_maps >= 0 && other_maps <= 1, "other_maps must be 0 to 1");
  need(frustum >= 0 && std::isfinite(frustum), "frustum must be 0 or more");
  for (double size : {landmark_size, point_size, feature_size, line_width})
    need(size > 0 && size <= 1000, "sizes must lie between 0 and 1000 pixels");
}

}  // namespace alidade::gles
