#include "alidade/semidense/settings.h"

#include <string>

#include "alidade/base/error.h"

namespace alidade {

void SemiDenseSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting semidense.") + what);
  };
  require(keyframes >= 1, "keyframes must be at least 1");
  require(min_gradient > 0, "min_gradient must be positive");
  require(max_edge_angle > 0 && max_edge_angle <= 90, "max_edge_angle must be between 0 and 90");
  require(max_turn > 0 && max_turn <= 180, "max_turn must be between 0 and 180");
  require(gradient_weight > 0, "gradient_weight must be positive");
  require(intensity_sigma > 0, "intensity_sigma must be positive");
  require(line_sigma >= 0, "line_sigma must not be negative");
  require(max_residual > 0, "max_residual must be positive");
  require(chi2_pair > 0 && chi2_check > 0, "chi2_pair and chi2_check must be positive");
  require(min_compatible >= 1, "min_compatible must be at least 1");
  require(keyframes >= min_compatible,
          "keyframes must be at least min_compatible: else none could ever agree");
  require(max_landmark_difference > 0, "max_landmark_difference must be positive");
  require(delay >= 0, "delay must not be negative");
  require(max_waiting > delay,
          "max_waiting must be more than delay: none would ever have its turn");
  require(redo_baseline > 0, "redo_baseline must be positive");
  require(voxel == 0 || voxel >= 1e-6, "voxel must be 0 or at least 1e-6");
}

}  // namespace alidade
