// Reads the results of a run (docs/reference/run-folder.md).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "alidade/evaluation/ate.h"
#include "alidade/geometry/camera.h"
#include "alidade/view/plots.h"

namespace alidade {

struct ResultFolder {
  std::string path;
  std::string source, sensor;
  std::string place;  // the source as an absolute path, where it is one; empty: not known
  // Of stats.json; what it does not say, or older versions did not, is empty.
  std::optional<double> frames, tracked, coverage, initialized_at, keyframes, landmarks, loops,
      relocalizations, maps, cpu_s, peak_mb;
  std::vector<MedianBar> milliseconds;  // one for each of kResultStages
  std::optional<Camera> camera;         // of the recording's images (stereo, fisheye: as rectified)
  TimeSpan span;                        // of the recording, seconds
  std::optional<double> first_pose;     // in any map, seconds
  std::vector<std::array<double, 2>> lost_spans;
  Trajectory trajectory;  // of the map with the most frames; empty: nothing was mapped
  Trajectory truth;       // groundtruth.txt, or that of the recording; empty: unknown

  bool mono() const { return sensor == "mono"; }
};

inline constexpr std::array kResultStages = {"frame", "extract",   "track",  "map",
                                             "loop",  "semidense", "detect", "dynamics"};

// Throws Error (input) for a folder without a valid stats.json of a run.
ResultFolder ReadResultFolder(const std::string& path);

}  // namespace alidade
