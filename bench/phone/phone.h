// What the phone's parameters and threads are worth: the tables of the paper the phone profile
// comes from, with the error and the coverage they cost beside each time
// (docs/benchmarks/speed.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/system/settings.h"
#include "bench/measure/recording.h"
#include "bench/measure/result.h"

namespace alidade::bench {

// Images alone, as one camera gives them; `count` frames at most. With the truth, where there is
// one. A camera that nothing is known of is found beforehand.
struct PhoneRecording {
  Recording recording;
  Trajectory truth;
};
PhoneRecording LoadPhoneRecording(const std::string& source, int count);

// One way to run it.
struct PhoneVariant {
  std::string name;
  SlamSettings settings;
  int threads = 1;  // of parallel loops; 0 = all. settings.threaded: played at the recording's rate
  std::string profile = {};  // whose settings these are; "": between desktop and phone
};

// What came of it. Milliseconds, one for each frame (map: for each keyframe).
struct PhoneRun {
  std::vector<double> frame, extract, track, map;
  Trajectory trajectory;  // of the largest map
  int keyframes = 0;
  double cpu =
      0;  // milliseconds of all threads, per frame: what else the machine does is not in it
};

PhoneRun RunNative(const PhoneRecording& recording, const PhoneVariant& variant);

// The same by the core as WebAssembly, in Node.js, on one thread. Nothing where that cannot be
// done: `problem` says why.
std::optional<PhoneRun> RunWasm(const PhoneRecording& recording, const SlamSettings& settings,
                                std::string* problem);

// The tables, and RANSAC serial and parallel. `frames` 0: 600 at most.
std::vector<Section> BenchPhone(const std::string& source, int frames);

}  // namespace alidade::bench
