#include "alidade/tracking/settings.h"

#include <string>

#include "alidade/base/error.h"

namespace alidade {

void TrackerSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("tracker.") + what);
  };
  extractor.Check();
  motion.Check();
  require(match_scale > 0 && match_scale <= 4, "match_scale must lie in (0, 4]");
  require(min_predicted > 0, "min_predicted must be positive");
  require(min_after_prediction >= 4, "min_after_prediction must be at least 4");
  require(min_tracked >= 6, "min_tracked must be at least 6");
  require(min_found_share >= 0 && min_found_share < 1, "min_found_share must lie in [0, 1)");
  require(min_relocalised_spread >= 0 && min_relocalised_spread < 0.5,
          "min_relocalised_spread must lie in [0, 0.5)");
  require(torn_share >= 0 && torn_share < 1, "torn_share must lie in [0, 1)");
  require(unproven_frames >= 0, "unproven_frames cannot be negative");
  require(unproven_seconds >= 0, "unproven_seconds cannot be negative");
  require(min_late_agreement >= 0 && min_late_agreement < 1,
          "min_late_agreement must lie in [0, 1)");
  require(min_agreement >= 0 && min_agreement < 1, "min_agreement must lie in [0, 1)");
  require(good_agreement >= 0 && good_agreement <= 1, "good_agreement must lie in [0, 1]");
  require(bad_frame_sigma >= 1, "bad_frame_sigma must be at least 1");
  require(max_distance > 0 && max_distance <= 256, "max_distance must lie in 1..256 bits");
  require(local_ratio > 0 && local_ratio <= 1, "local_ratio must lie in (0, 1]");
  require(last_frame_radius > 0 && last_frame_radius_depth > 0 && local_radius > 0 &&
              local_radius_depth > 0,
          "radii must be positive");
  require(relocalise_radius > 0, "relocalise_radius must be positive");
  require(min_relocalised >= 10, "min_relocalised must be at least 10");
  require(min_relocalised_share >= 0 && min_relocalised_share <= 1,
          "min_relocalised_share must lie in [0, 1]");
  require(local_keyframes > 0, "local_keyframes must be positive");
  require(predict_seconds >= 0, "predict_seconds cannot be negative");
  require(depth_range > 0, "depth_range must be positive");
  require(noise.sigma_px > 0 && noise.sigma_right_px > 0, "noise must be positive");
  require(keyframe_min_gap >= 0 && keyframe_max_gap > keyframe_min_gap,
          "keyframe_max_gap must exceed keyframe_min_gap");
  require(keyframe_share_mono > 0 && keyframe_share_depth > 0, "keyframe_share_* must be positive");
}

}  // namespace alidade
