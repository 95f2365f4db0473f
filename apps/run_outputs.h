// What `alidade run` leaves behind (docs/formats.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/slam.h"

namespace alidade {

// All that is known of a run besides the map.
struct RunRecord {
  SourceInfo source;
  std::string source_path;
  Sensor sensor = Sensor::kMono;
  SlamSettings settings;
  std::string profile;
  std::vector<std::string> stamps;     // one per frame given to Track()
  std::vector<int> numbers;            // their numbers in the recording
  std::vector<TrackState> states;
  int frames = 0;                      // of the recording, bad ones included
  int dropped = 0;                     // bad or skipped ones
  double cpu_s = 0, wall_s = 0;
  int threads = 0;
  std::vector<std::string> warnings;
};

// Makes the folder, or clears an earlier run's files out of it. Throws Error (input) when it holds anything else or
// cannot be written.
void PrepareOutput(const std::string& folder);

// Writes everything; each file whole or not at all. Returns the number of tracked frames.
int WriteOutputs(const std::string& folder, const Slam& slam, const RunRecord& record);

}  // namespace alidade
