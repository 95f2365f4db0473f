// What a run was asked to do, and with what.
#pragma once

#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"
#include "alidade/run/setup/run_settings.h"

namespace alidade {

struct RunSetup {
  std::string source_path;  // as typed
  SourceInfo source;        // as opened: its camera may be a guess, see CameraFinding
  SourceOptions reading;    // how it was opened
  RunSettings settings;     // as used
  std::string profile;
  std::string repeat_words;  // RepeatWords() of the options
  int threads = 0;
  bool map_in_meters = false;  // the loaded map is of a sensor with depth
};

}  // namespace alidade
