#include "alidade/mapping/settings.h"

#include <string>

#include "alidade/base/error.h"

namespace alidade {

void MapperSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("mapper.") + what);
  };
  require(noise.sigma_px > 0 && noise.sigma_right_px > 0, "noise must be positive");
  require(match_scale > 0 && match_scale <= 4, "match_scale must lie in (0, 4]");
  require(max_depth_error > 0, "max_depth_error must be positive");
  require(noise.sensor_noise > 0, "sensor_noise must be positive");
  require(triangulate_keyframes_mono > 0 && triangulate_keyframes_depth >= 0,
          "triangulate_keyframes_* cannot be negative");
  require(triangulate_ratio > 0 && triangulate_ratio <= 1, "triangulate_ratio must lie in (0, 1]");
  require(min_parallax_degrees > 0 && min_parallax_degrees < 90,
          "min_parallax_degrees must lie in (0, 90)");
  require(fuse_keyframes >= 0 && fuse_radius > 0, "fuse_* cannot be negative");
  require(min_found_share >= 0 && min_found_share <= 1, "min_found_share must lie in [0, 1]");
  require(redundant_share > 0, "redundant_share must be positive");
  require(min_parallax_degrees_mono > 0 && min_parallax_degrees_mono < 90,
          "min_parallax_degrees_mono must lie in (0, 90)");
  require(max_baseline_error > 0, "max_baseline_error must be positive");
  require(enough_known_scale >= 0 && min_known_scale >= 0, "*_known_scale cannot be negative");
  require(max_unknown_scale_seconds >= 0, "max_unknown_scale_seconds cannot be negative");
  require(max_unknown_scale_motion >= 0, "max_unknown_scale_motion cannot be negative");
  require(turn_landmarks >= 0, "turn_landmarks cannot be negative");
  require(turn_radius > 0, "turn_radius must be positive");
  require(assumed_depth_error >= 0, "assumed_depth_error cannot be negative");
  require(assumed_depth_degrees >= 0 && assumed_depth_degrees < 90,
          "assumed_depth_degrees must lie in [0, 90)");
  require(window_shared >= 1, "window_shared must be positive");
  require(window_iterations_mono >= 1, "window_iterations_mono must be positive");
  require(least_noise > 0 && least_noise <= 1, "least_noise must be above 0 and at most 1");
  require(window_keyframes >= 1 && window_fixed >= 1, "window_* must be positive");
  require(max_keyframes >= 0, "max_keyframes cannot be negative");
  require(max_keyframes == 0 || max_keyframes >= 10,
          "max_keyframes must be 0 or at least 10: a camera needs some around it");
  bundle.Check();
}

}  // namespace alidade
