// The options of a run.
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
  std::optional<std::string> fov;     // degrees, as typed: "70", or "~70" if approximate
  bool calibrate_first = true;        // calibrate an unknown camera before the run
  std::vector<std::string> settings;  // "name=value"
  std::optional<uint64_t> seed;
  int threads = 0;  // 0: all cores
  int first = 0, last = -1, repeat = 0;
  bool quiet = false;
  bool localize = false;  // only find poses in the loaded map
  bool semidense = false;
  std::optional<std::string> dynamics, detector;
  std::shared_ptr<Detector> own_detector;  // detector of the caller instead of a file
  bool write_masks = false;
  std::optional<std::string> imu;        // "off", or a file of readings; nullopt: the source's own
  std::optional<std::string> mask;       // image: what is white in it is left out of all frames
  bool overwrite = false;                // replace any existing results
  bool record = false;                   // the stream, as run.stream in the result folder
  std::optional<std::string> record_to;  // the stream, to this file instead
  bool viewer = false;                   // show it in a browser
  std::optional<std::string> port;       // of the viewer; 8090 or the next free one
  std::optional<std::string> host;       // address the viewer listens on; 127.0.0.1
  // Where the program tells each pose as it comes: "-", "udp:HOST:PORT", or "json:" and one of
  // them.
  std::optional<std::string> poses;
  std::string base_frame;  // of the robot, for a source of ROS: SourceOptions::base_frame
};

// Upper bound on threads: more threads than cores do not help, and each reserves 8 MB of stack.
inline constexpr int kMostThreads = 256;
// Throws Error (usage) for an invalid value of --threads.
void CheckThreads(int threads);

// True for a detector file and for a detector of the caller.
inline bool HasDetector(const RunOptions& options) {
  return options.detector || options.own_detector;
}

// File the stream is recorded to; empty: run.stream in the result folder; nullopt: not recorded.
inline std::optional<std::string> RecordFileOf(const RunOptions& options) {
  if (options.record_to) return options.record_to;
  return options.record ? std::optional<std::string>("") : std::nullopt;
}

// Throws Error (usage) for contradicting options.
void CheckRunOptions(const RunOptions& options);

// Throws Error (usage) for an unknown word; `option` is the option it was given for.
Sensor SensorNamed(const std::string& option, const std::string& word);

SourceOptions SourceOptionsFrom(const RunOptions& options);

// Profile, then the file of --config, then each --set, then the flags (--seed, --semidense): later
// ones have priority. Sensor and schedule depend on the source. Throws Error (usage, or input for
// the file).
RunSettings SettingsFrom(const RunOptions& options);

// The options that decide what a run computes, apart from those of SourceOptions and --semidense,
// as words for a shell with a space before each: " --profile phone --set tracker.min_found=20".
std::string RepeatWords(const RunOptions& options);

// True if stages run in their own threads: as requested, by default only for a live camera.
bool ThreadedFrom(const RunOptions& options, bool live);

// Playback speed of a recording.
struct Rate {
  enum class Kind {
    kMax,       // as fast as possible
    kRealtime,  // by the time stamps
    kFixed      // `fps` frames per second
  } kind = Kind::kMax;
  double fps = 0;
};

// The default is realtime if threaded, else kMax. Live images come at their own times: realtime is
// kMax there. Waiting for their time stamps would add what the first image was late by, and the
// drift between the camera's clock and this one.
Rate RateFrom(const RunOptions& options, bool threaded, bool live);

}  // namespace alidade
