// What `alidade run` was asked to do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/files/open_source.h"
#include "alidade/system/settings.h"

namespace CLI {
class App;
}

namespace alidade {

struct RunOptions {
  std::string source;
  std::optional<std::string> sensor, camera_file, config, schedule, rate, out, load;
  std::string profile = "desktop";
  std::optional<double> fov_degrees;
  std::vector<std::string> settings;  // "name=value"
  std::optional<uint64_t> seed;
  int threads = 0;  // 0: all cores
  int first = 0, last = -1, repeat = 0;
  bool quiet = false;
  bool localise = false;  // only find poses in the loaded map
  bool semidense = false;
  std::optional<std::string> dynamics, detector;
  bool write_masks = false;
  // Known words whose work is not in this version.
  std::optional<std::string> viewer, host;
};

// Adds the flags; parsing fills `options`, which must outlive `command`.
void AddRunOptions(CLI::App& command, RunOptions& options);
// The same for `alidade localize`.
void AddLocalizeOptions(CLI::App& command, RunOptions& options);

// Throws Error (usage) for what this version cannot do yet, and for flags that do not go together.
void CheckRunOptions(const RunOptions& options);

// Throws Error (usage) for a word that names none; `option` is whose word it is.
Sensor SensorNamed(const std::string& option, const std::string& word);

SourceOptions SourceOptionsFrom(const RunOptions& options);

// Profile, then the file of --config, then each --set, then the flags (--seed, --semidense): the
// later one holds. The sensor
// and the schedule are the source's to say. Throws Error (usage, or input for the file).
SlamSettings SettingsFrom(const RunOptions& options);

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
