// One run of `alidade-bench wild`, and how good it was.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "alidade/system/settings.h"
#include "bench/wild/cases.h"

namespace alidade::bench {

struct WildRun {
  uint64_t seed = 1;
  int frames = 0;
  int usable = -1;  // the first frame by which the camera has moved enough; -1: never
  int start = -1;   // the first tracked frame; -1: none
  int tracked = 0;  // frames, in all maps
  double coverage =
      std::numeric_limits<double>::quiet_NaN();  // of those from a second after `usable`
  int maps = 0;                                  // that frames were placed in
  int false_poses = 0;                           // frames
  int false_maps = 0;
  // Of the map with the most frames; NaN: nothing to tell.
  double ate_cm = std::numeric_limits<double>::quiet_NaN();       // after Sim(3)
  double ate_percent = std::numeric_limits<double>::quiet_NaN();  // of its path
  double scale_drift = std::numeric_limits<double>::quiet_NaN();
  double milliseconds = 0;  // per frame, rendering left out
  std::string reason;       // that most of the frames without a pose have
};

// One camera, inline, as `alidade run` does it. `frames`: at most; 0: all. `progress` is told the
// number of frames done.
WildRun RunWild(const WildCase& of, uint64_t seed, int frames, SlamSettings settings,
                const std::function<void(int)>& progress);

}  // namespace alidade::bench
