// What happened in a run, besides the map and the trajectory.
#pragma once

#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/run/results/frame_stamps.h"
#include "alidade/run/results/keyframe_album.h"
#include "alidade/run/results/untracked.h"
#include "alidade/system/health.h"

namespace alidade {

struct RunLog {
  FrameStamps stamps;                           // of the frames that Track() took
  std::optional<double> first_time, last_time;  // of all that came, seconds
  std::map<std::string, int> untracked_reasons;
  UntrackedLog untracked;
  KeyframeAlbum album;
  std::string first_problem;  // of a bad frame
  Trajectory truth;           // of rendered recordings

  double cpu_s = 0;   // CPU time of all threads, reading images left out, seconds
  double wall_s = 0;  // seconds
  std::vector<std::string> warnings;
  std::exception_ptr failure;  // the source's, that ended the run early
  std::exception_ptr bug;      // of the first frame that failed because of a bug
  SlamHealth health;           // at the end

  // Small ones side by side, which saves the gaps between larger ones.
  int frames = 0;      // all that came, bad ones included
  int late = 0;        // skipped for newer ones, not counted in `frames`
  int dropped = 0;     // bad ones
  int incomplete = 0;  // whose depth or right image could not be read
  int dark = 0;        // black ones among those that were not tracked
  bool interrupted = false;
};

// Why nothing could be mapped, in words for the user.
std::string WhyNothing(const RunLog& log);

}  // namespace alidade
