#include "alidade/run/setup/options.h"

#include "alidade/base/choice.h"
#include "alidade/base/error.h"
#include "alidade/base/shell_quoted.h"
#include "alidade/io/text.h"
#include "alidade/run/setup/settings_file.h"

namespace alidade {

void CheckThreads(int threads) {
  if (threads >= 0 && threads <= kMostThreads) return;
  ThrowUsage("--threads must be from 0 (one for each core) to " + std::to_string(kMostThreads) +
             ", not " + std::to_string(threads));
}

void CheckRunOptions(const RunOptions& options) {
  if (options.semidense && options.localize) {
    ThrowUsage("--semidense is not available for localize, which does not extend the map");
  }
  if (options.host && !options.viewer) ThrowUsage("--host requires --viewer");
  if (options.port && !options.viewer) ThrowUsage("--port requires --viewer");
  if (options.record_to && options.record_to->empty()) ThrowUsage("--record-to must not be empty");
  if (options.imu && options.imu->empty()) ThrowUsage("--imu must be a file, or off");
  if (options.detector && options.own_detector)
    ThrowUsage("give one detector: a file or a function");
  CheckThreads(options.threads);
  if (options.repeat < 0) ThrowUsage("--repeat must not be negative");
  if (options.source.empty()) ThrowUsage("SOURCE must not be empty");
}

Sensor SensorNamed(const std::string& option, const std::string& word) {
  std::vector<std::pair<std::string, Sensor>> sensors;
  for (Sensor sensor : {Sensor::kMono, Sensor::kStereo, Sensor::kRgbd})
    sensors.push_back({NameOf(sensor), sensor});
  return Choice<Sensor>(option, word, sensors);
}

SourceOptions SourceOptionsFrom(const RunOptions& options) {
  SourceOptions source;
  if (options.sensor) {
    source.sensor = SensorNamed("--sensor", *options.sensor);
  }
  source.camera_file = options.camera_file;
  if (options.fov) {
    source.fov_rough = options.fov->rfind('~', 0) == 0;
    source.fov_degrees = ParseNumber(options.fov->substr(source.fov_rough ? 1 : 0));
    if (!source.fov_degrees || !(*source.fov_degrees > 0 && *source.fov_degrees < 180)) {
      ThrowUsage(
          "--fov must be a number of degrees between 0 and 180, with ~ if it is approximate (70 or "
          "~70), not '" +
          *options.fov + "'");
    }
  }
  source.imu = options.imu;
  source.base_frame = options.base_frame;
  source.first = options.first;
  source.last = options.last;
  return source;
}

RunSettings SettingsFrom(const RunOptions& options) {
  RunSettings all;
  SlamSettings& settings = all.slam;
  settings.ApplyProfile(options.profile);
  if (options.config) ApplySettingsFile(*options.config, all);
  for (const std::string& assignment : options.settings) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos) ThrowUsage("--set " + assignment + ": expected name=value");
    all.Set(assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  if (options.seed) settings.seed = *options.seed;
  if (options.semidense) settings.semidense.enabled = true;
  if (options.dynamics) {
    settings.dynamics.mode = DynamicsModeNamed("--dynamics", *options.dynamics);
  } else if (HasDetector(options)) {
    settings.dynamics.mode = DynamicsMode::kFull;
  }
  const DynamicsMode mode = settings.dynamics.mode;
  if (mode == DynamicsMode::kFull && !HasDetector(options))
    ThrowUsage("--dynamics full needs --detector MODEL.onnx");
  if (mode != DynamicsMode::kFull && HasDetector(options))
    ThrowUsage(std::string("--detector cannot be used with --dynamics ") + NameOf(mode));
  if (!LeavesOutFromStart(mode) && options.write_masks)
    ThrowUsage(
        "--write-masks requires --dynamics geometry or full: otherwise moving objects are not left "
        "out from the start");
  all.Check();
  return all;
}

std::string RepeatWords(const RunOptions& options) {
  std::string words;
  const auto add = [&](const std::string& name, const std::string& value) {
    words += " " + name + " " + ShellWord(value);
  };
  const auto add_if = [&](const std::string& name, const std::optional<std::string>& value) {
    if (value) add(name, *value);
  };
  if (options.profile != "desktop") add("--profile", options.profile);
  add_if("--config", options.config);
  for (const std::string& assignment : options.settings) add("--set", assignment);
  if (options.seed) add("--seed", std::to_string(*options.seed));
  if (!options.calibrate_first) words += " --no-calibrate-first";
  if (options.first > 0) add("--first", std::to_string(options.first));
  if (options.last >= 0) add("--last", std::to_string(options.last));
  add_if("--load", options.load);
  add_if("--dynamics", options.dynamics);
  add_if("--detector", options.detector);
  add_if("--mask", options.mask);
  add_if("--schedule", options.schedule);
  return words;
}

bool ThreadedFrom(const RunOptions& options, bool live) {
  if (!options.schedule) return live;
  return Choice<bool>("--schedule", *options.schedule, {{"inline", false}, {"threaded", true}});
}

Rate RateFrom(const RunOptions& options, bool threaded, bool live) {
  const Rate realtime = {live ? Rate::Kind::kMax : Rate::Kind::kRealtime, 0};
  if (!options.rate) return threaded ? realtime : Rate();
  if (*options.rate == "realtime") return realtime;
  if (*options.rate == "max") return {};
  const std::optional<double> fps = ParseNumber(*options.rate);
  constexpr double kSlowest = 1e-3;  // one frame in 17 minutes; lower values are typing errors
  if (!fps || !(*fps >= kSlowest && *fps <= 1e6)) {
    ThrowUsage("--rate must be realtime, max or frames per second (0.001 to 1000000), not '" +
               *options.rate + "'");
  }
  return {Rate::Kind::kFixed, *fps};
}

}  // namespace alidade
