// All settings of a run by name: those of SLAM, of the stream, of image conditions, of the
// distortion check and of the calibration.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/calibration/lens_check.h"
#include "alidade/run/results/image_condition.h"
#include "alidade/run/setup/calibrate_settings.h"
#include "alidade/run/setup/stream_settings.h"
#include "alidade/system/settings.h"

namespace alidade {

struct RunSettings {
  SlamSettings slam;
  StreamFeedSettings stream;    // stream.…
  LookSettings look;            // look.…
  LensCheckSettings lens;       // lens.…
  CalibrateSettings calibrate;  // calibrate.…
  void Check() const;           // throws Error (usage) naming the invalid setting

  // All structs with their tables.
  std::vector<SettingsPart> Parts();
  // As SlamSettings::Set() and All().
  void Set(const std::string& name, const std::string& value);
  std::vector<std::pair<std::string, std::string>> All() const;
};

}  // namespace alidade
