// SLAM among moving people: the tables of docs/benchmarks/dynamic.md, "dynamic".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/measure/result.h"

namespace alidade::bench {

struct DynamicOptions {
  std::vector<std::string> sources;     // none: rendered rooms with people
  std::optional<std::string> detector;  // none: only what works without
  std::optional<std::string> camera;    // calibration of all that are recorded; none: their own
  std::vector<std::string> sensors;     // none: what the recording has, and one camera
  std::vector<std::string> plain;       // the same frames without people, one for each source
  std::vector<std::string> settings;    // name=value, of every run
  std::string pictures;                 // folder for pictures of the features; "": none
  int frames = 0;                       // of each source, at most; 0: rendered 200, recorded all
  int seeds = 1;
  bool ablation = false, latency = false, live = true;
};

// Throws Error: usage for options that cannot be, input for sources that cannot be read.
Section BenchDynamic(const DynamicOptions& options);

}  // namespace alidade::bench
