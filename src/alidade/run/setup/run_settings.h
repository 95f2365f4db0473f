// All settings of a run, by name: the system's, those of the stream, of how pictures without a pose
// are judged, and of what the lens is asked.
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

  // Every struct with its table.
  std::vector<SettingsPart> Parts();
  // As SlamSettings::Set() and All().
  void Set(const std::string& name, const std::string& value);
  std::vector<std::pair<std::string, std::string>> All() const;
};

}  // namespace alidade
