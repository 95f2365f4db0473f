#include "alidade/semidense/settings.h"

#include <string>

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> SemiDenseSettings::Table() {
  using T = SemiDenseSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::enabled>("semidense.enabled", kOnOff, "",
                                 "Compute semi-dense depth of the keyframes."),
      PublicSetting<&T::keyframes>("semidense.keyframes", kPositive, "keyframes",
                                   "Best covisible keyframes searched for each pixel."),
      PublicSetting<&T::min_gradient>("semidense.min_gradient", kPositive, "gray levels/px",
                                      "Pixels with a smaller gradient get no depth."),
      PublicSetting<&T::min_compatible>(
          "semidense.min_compatible", kPositive, "keyframes",
          "Keyframes that must agree on a depth; more gives fewer, better points."),
      PublicSetting<&T::max_waiting>(
          "semidense.max_waiting", kPositive, "keyframes",
          "Most keyframes waiting for depth; beyond, the oldest get none."),
      PublicSetting<&T::voxel>(
          "semidense.voxel", ZeroOr(AtLeast(1e-6)), "m or map units",
          "Edge of the cubes that keep one point each in semidense.ply; 0: all points."),
      ExpertSetting<&T::from_sensor>("semidense.from_sensor", kOnOff, "",
                                     "RGB-D: take the depth camera's depth instead, to compare."),
      ExpertSetting<&T::max_edge_angle>(
          "semidense.max_edge_angle", {.min = 0, .max = 90, .open_min = true}, "degrees",
          "Largest angle between a pixel's gradient and the epipolar line."),
      ExpertSetting<&T::max_turn>("semidense.max_turn", {.min = 0, .max = 180, .open_min = true},
                                  "degrees",
                                  "Largest difference between the gradient directions of a match."),
      ExpertSetting<&T::intensity_sigma>("semidense.intensity_sigma", kPositive, "gray levels",
                                         "Standard deviation of the intensities of a match."),
      ExpertSetting<&T::max_residual>(
          "semidense.max_residual", kPositive, "gray levels",
          "Largest root mean square difference between the surroundings of a match."),
      ExpertSetting<&T::max_landmark_difference>("semidense.max_landmark_difference", kPositive, "",
                                                 "A keyframe's depth is kept when three quarters "
                                                 "of it lie this near to landmarks beside it, "
                                                 "in relative inverse depth."),
      ExpertSetting<&T::fuse>("semidense.fuse", kOnOff, "",
                              "Fuse hypotheses; 0: the one with the smallest variance."),
      ExpertSetting<&T::smooth>("semidense.smooth", kOnOff, "",
                                "Smooth depth with the neighbors in the keyframe."),
      ExpertSetting<&T::cross_check>("semidense.cross_check", kOnOff, "",
                                     "Check depth against that of other keyframes."),
      ExpertSetting<&T::delay>("semidense.delay", kNotNegative, "keyframes",
                               "Keyframes that must follow before one gets its depth."),
      ExpertSetting<&T::redo_baseline>(
          "semidense.redo_baseline", kPositive, "",
          "Depth is computed again when a baseline changed by this share."),
  };
  return kRows;
}

void SemiDenseSettings::Check() const {
  CheckRanges(*this);
  if (keyframes < min_compatible) {
    ThrowUsage(
        "setting semidense.keyframes must be at least semidense.min_compatible: otherwise no "
        "depth could ever be confirmed");
  }
  if (max_waiting <= delay) {
    ThrowUsage(
        "setting semidense.max_waiting must exceed expert.semidense.delay: otherwise no "
        "keyframe would ever get its depth");
  }
}

}  // namespace alidade
