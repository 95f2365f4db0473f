// What a run can be asked to do.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/detect/detector.h"
#include "alidade/io/files/open_source.h"
#include "alidade/run/setup/run_settings.h"

namespace alidade {

struct RunOptions {
  std::string source;
  std::optional<std::string> sensor, camera_file, config, schedule, rate, out, load;
  std::string profile = "desktop";
  std::optional<std::string> fov;     // degrees, as typed: "70", or "~70" for a guess
  bool calibrate_first = true;        // find a camera of which nothing is known
  std::vector<std::string> settings;  // "name=value"
  std::optional<uint64_t> seed;
  int threads = 0;  // 0: all cores
  int first = 0, last = -1, repeat = 0;
  bool quiet = false;
  bool localise = false;  // only find poses in the loaded map
  bool semidense = false;
  std::optional<std::string> dynamics, detector;
  std::shared_ptr<Detector> own_detector;  // instead of a file's: the caller's own
  bool write_masks = false;
  bool overwrite = false;                // replace whatever results are in the folder
  bool record = false;                   // the stream, as run.stream among the results
  std::optional<std::string> record_to;  // the stream, to this file instead
  bool viewer = false;                   // show it in a browser
  std::optional<std::string> port;       // the viewer listens on; 8090 or the next that is free
  std::optional<std::string> host;       // address the viewer listens on; 127.0.0.1
};

// More threads than cores only wait for each other, and each has 8 MB of stack to its name; no
// machine this is meant for has as many cores.
inline constexpr int kMostThreads = 256;
// Of --threads: throws Error (usage) for a number that cannot be.
void CheckThreads(int threads);

// A file's, or the caller's own.
inline bool HasDetector(const RunOptions& options) {
  return options.detector || options.own_detector;
}

// File the stream is recorded to; empty: run.stream among the results; nothing: not recorded.
inline std::optional<std::string> RecordFileOf(const RunOptions& options) {
  if (options.record_to) return options.record_to;
  return options.record ? std::optional<std::string>("") : std::nullopt;
}

// Throws Error (usage) for flags that do not go together.
void CheckRunOptions(const RunOptions& options);

// Throws Error (usage) for a word that names none; `option` is whose word it is.
Sensor SensorNamed(const std::string& option, const std::string& word);

SourceOptions SourceOptionsFrom(const RunOptions& options);

// Profile, then the file of --config, then each --set, then the flags (--seed, --semidense): the
// later one holds. The sensor
// and the schedule are the source's to say. Throws Error (usage, or input for the file).
RunSettings SettingsFrom(const RunOptions& options);

// Whether stages run on their own threads: as asked, else only for a live camera.
bool ThreadedFrom(const RunOptions& options, bool live);

// How fast a recording is played.
struct Rate {
  enum class Kind {
    kMax,       // as fast as it goes
    kRealtime,  // each frame at its own time stamp
    kFixed      // `fps` frames per second
  } kind = Kind::kMax;
  double fps = 0;
};

// Without --rate: realtime when threaded, else as fast as it goes.
Rate RateFrom(const RunOptions& options, bool threaded);

}  // namespace alidade
