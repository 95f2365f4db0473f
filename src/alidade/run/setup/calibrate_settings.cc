#include "alidade/run/setup/calibrate_settings.h"

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> CalibrateSettings::Table() {
  using T = CalibrateSettings;
  static constexpr Setting kRows[] = {
      SameSetting<&T::first_keyframes>("camera.first_keyframes", AtLeast(6)),
      SameSetting<&T::growth>("camera.growth", MoreThan(1)),
      PublicSetting<&T::enabled>("calibrate.enabled", kOnOff, "",
                                 "One camera: calibrate an unknown camera before the run."),
      ExpertSetting<&T::max_seconds>("calibrate.max_seconds", kPositive, "s",
                                     "Length of the recording's part that is used."),
      ExpertSetting<&T::max_passes>("calibrate.max_passes", AtLeast(1), "",
                                    "Most passes over the recording."),
      ExpertSetting<&T::max_off>("calibrate.max_off", kPositive, "",
                                 "A pass ends when the camera differs by more than this share from "
                                 "the one it began with."),
      ExpertSetting<&T::max_restart_sigma>(
          "calibrate.max_restart_sigma", kPositive, "",
          "Relative standard deviation of a focal length with which a new pass begins."),
      ExpertSetting<&T::max_retry_sigma>("calibrate.max_retry_sigma", kPositive, "",
                                         "The same at the end of the recording."),
      ExpertSetting<&T::retry_bend>(
          "calibrate.retry_bend", {.min = -0.3, .max = 0.3, .open_min = true, .open_max = true}, "",
          "A search without result starts again with this shift at the image corners; 0: it does "
          "not."),
      ExpertSetting<&T::enough_sigma>(
          "calibrate.enough_sigma", kPositive, "",
          "A pass ends early below this relative standard deviation of the focal length."),
      ExpertSetting<&T::told_sigma>(
          "calibrate.told_sigma", kPositive, "",
          "Relative standard deviation of a focal length from the recording's metadata."),
  };
  return kRows;
}

void CalibrateSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting expert.") + what);
  };
  CameraEstimateSettings::Check();
  CheckRanges(*this);
  require(max_retry_sigma >= max_restart_sigma,
          "calibrate.max_retry_sigma must be at least expert.calibrate.max_restart_sigma");
  require(first_keyframes >= min_keyframes,
          "camera.first_keyframes must be at least expert.calibrate.min_keyframes");
}

}  // namespace alidade
