// Hours in one place: what memory and time per frame do as ids and frames pile up.
#pragma once

#include <string>

#include "bench/measure/result.h"

namespace alidade::bench {

// Plays a recording forth and back until `frames` frames have been tracked, threaded, as
// fast as it goes; then saves the map, loads it, and localises the recording in it. `sensor` empty:
// the recording's own.
Section BenchLasting(const std::string& source, int frames, const std::string& sensor);

}  // namespace alidade::bench
