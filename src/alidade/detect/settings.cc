#include "alidade/detect/settings.h"

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> DetectorSettings::Table() {
  using T = DetectorSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::min_score>("dynamics.detector.min_score",
                                   {.min = 0, .max = 1, .open_min = true, .open_max = true}, "",
                                   "Detections with a lower score are ignored."),
      PublicSetting<&T::max_overlap>("dynamics.detector.max_overlap", kPositiveShare, "",
                                     "Of two detections of a class with a higher intersection over "
                                     "union, the better one stays."),
  };
  return kRows;
}

void DetectorSettings::Check() const { CheckRanges(*this); }

}  // namespace alidade
