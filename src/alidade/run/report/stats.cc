#include "alidade/run/report/stats.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/base/timing.h"
#include "alidade/run/folder/output_folder.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

constexpr int kStatsVersion = 1;

ordered_json ToJson(const std::vector<double>& samples) {
  if (samples.empty()) return nullptr;
  const Summary s = Summarise(samples);
  return {
      {"median", s.median}, {"mean", s.mean}, {"p95", s.p95}, {"max", s.max}, {"count", s.count}};
}

ordered_json SettingsJson(const RunSetup& setup) {
  ordered_json settings = {{"profile", setup.profile},
                           {"schedule", setup.settings.slam.threaded ? "threaded" : "inline"},
                           {"threads", setup.threads}};
  for (const auto& [name, value] : setup.settings.All()) {
    const ordered_json parsed = ordered_json::parse(value, nullptr, false);
    settings[name] = parsed.is_discarded() ? ordered_json(value) : parsed;
  }
  return settings;
}

// What the source was opened with, so that it can be opened again.
ordered_json ReadingJson(const SourceOptions& reading) {
  const auto optional = [](const auto& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  std::optional<std::string> camera = reading.camera_file, imu = reading.imu;
  std::error_code error;
  for (std::optional<std::string>* path : {&camera, &imu}) {
    if (*path && **path != kNoImu)
      *path = std::filesystem::absolute(**path, error).lexically_normal().string();
  }
  return {{"camera", optional(camera)},
          {"fov", optional(reading.fov_degrees)},
          {"imu", optional(imu)},
          {"first", reading.first},
          {"last", reading.last}};
}

// What semi-dense mapping did; null when it was not asked for.
ordered_json SemiDenseJson(const SlamSettings& settings, const SemiDenseReport& report) {
  if (!settings.semidense.enabled || settings.localize) return nullptr;
  const auto mean = [](int64_t sum, int64_t count) {
    return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0.0;
  };
  return {{"keyframes", report.keyframes},
          {"pixels", mean(report.pixels, report.keyframes)},
          {"searches", mean(report.search.searches, report.keyframes)},
          {"mean_search", mean(report.search.samples, report.search.searches)},
          {"most_behind", report.most_behind}};
}

// Result of the distortion check; null: too few keyframes.
ordered_json LensJson(const LensCheck& lens) {
  if (lens.windows == 0) return nullptr;
  return {{"k1", lens.k1},
          {"sigma", lens.sigma},
          {"bend", lens.bend},
          {"windows", lens.windows},
          {"strong", lens.strong}};
}

ordered_json CameraJson(const CameraFinding& finding) {
  const Camera& camera = finding.camera;
  const double sigma = finding.focal_sigma;
  return {{"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"distortion", camera.distortion},
          {"readout", finding.readout},
          {"readout_sigma",
           finding.readout_sigma > 0 ? ordered_json(finding.readout_sigma) : ordered_json(nullptr)},
          {"fov", FovDegrees(camera)},
          {"fx_sigma", sigma > 0 ? ordered_json(sigma * camera.fx) : ordered_json(nullptr)},
          {"known", finding.known}};
}

// How it was found; null: it was not looked for.
ordered_json CalibrationJson(const CameraFinding& finding) {
  if (!finding.found) return nullptr;
  const CameraFound& found = *finding.found;
  return {{"passes", found.passes},
          {"frames", found.frames},
          {"keyframes", found.estimate.keyframes},
          {"observations", found.estimate.observations},
          {"k1_sigma", found.estimate.k1_sigma},
          {"k2_sigma", found.estimate.k2_sigma},
          {"noise", found.estimate.noise},
          {"why_not", found.why_not},
          {"cpu_s", finding.cpu_s},
          {"wall_s", finding.wall_s}};
}

ordered_json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// A standard deviation; 0: unknown.
ordered_json SigmaJson(double sigma) {
  return sigma > 0 ? ordered_json(sigma) : ordered_json(nullptr);
}

ordered_json GravityJson(const InertialReport& inertial) {
  return inertial.gravity ? ToJson(*inertial.gravity) : ordered_json(nullptr);
}

// What is known of the inertial sensor; null: no readings.
ordered_json ImuJson(const InertialReport& inertial) {
  if (!inertial.given) return nullptr;
  const ImuModel& model = inertial.model;
  const bool offset = model.time_offset_known || inertial.time_offset_sigma > 0;
  const bool bias = inertial.gravity && inertial.left_out.empty();
  return {{"samples", inertial.samples},
          {"rate", model.rate > 0 ? ordered_json(model.rate) : ordered_json(nullptr)},
          {"time_offset", offset ? ordered_json(model.time_offset) : ordered_json(nullptr)},
          {"time_offset_sigma", SigmaJson(inertial.time_offset_sigma)},
          {"gyro_bias", bias ? ToJson(inertial.bias.gyro) : ordered_json(nullptr)},
          {"accel_bias", bias ? ToJson(inertial.bias.accel) : ordered_json(nullptr)}};
}

// Parts that failed and stopped.
ordered_json StoppedJson(const SlamHealth& health) {
  ordered_json stopped = ordered_json::array();
  for (const StageHealth& stage : health.stages) {
    if (!stage.running) stopped.push_back({{"part", stage.name}, {"failure", stage.failure}});
  }
  return stopped;
}

// The frames of each map, and the files with its poses.
ordered_json MapFiles(const RunResults& results) {
  ordered_json files = ordered_json::array();
  for (size_t i = 0; i < results.maps.size(); ++i) {
    const MapResults& map = results.maps[i];
    if (map.trajectory.empty()) continue;
    files.push_back({{"trajectory", NumberedFile("trajectory", i)},
                     {"keyframes", NumberedFile("keyframes", i)},
                     {"frames", map.trajectory.size()},
                     {"keyframe_count", map.keyframes.size()},
                     {"span", {map.trajectory.front().time, map.trajectory.back().time}}});
  }
  return files;
}

}  // namespace

bool IsMetric(const RunSetup& setup, const MapResults& map) {
  return setup.settings.slam.sensor != Sensor::kMono || setup.map_in_meters || map.meters;
}

std::string StatsJson(const RunSetup& setup, const CameraFinding& camera, const RunLog& log,
                      const RunResults& results) {
  const int tracked = results.tracked;
  const auto optional = [](const std::optional<int>& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  const ordered_json stats = {
      {"version", kStatsVersion},
      {"source", setup.source_path},
      {"sensor", NameOf(setup.settings.slam.sensor)},
      {"reading", ReadingJson(setup.reading)},
      {"settings", SettingsJson(setup)},
      {"camera", CameraJson(camera)},
      {"calibration", CalibrationJson(camera)},
      {"frames", log.frames},
      {"tracked", tracked},
      {"coverage", log.frames > 0 ? static_cast<double>(tracked) / log.frames : 0.0},
      {"initialized_at", optional(results.initialized_at)},
      {"lost_spans", results.lost_spans},
      {"span",
       log.first_time ? ordered_json({*log.first_time, *log.last_time}) : ordered_json(nullptr)},
      {"relocalizations", results.counts.relocalizations},
      {"predicted", results.counts.predicted},
      {"loops", results.counts.loops},
      {"merges", results.counts.merges},
      {"cuts", results.counts.cuts},
      {"left_out", results.counts.left_out},
      {"gravity", GravityJson(results.inertial)},
      {"scale",
       {{"known", IsMetric(setup, results.maps.front())},
        {"sigma", SigmaJson(results.inertial.scale_sigma)}}},
      {"imu", ImuJson(results.inertial)},
      {"maps", results.map.Maps().size()},
      {"map_files", MapFiles(results)},
      {"keyframes", results.map.keyframe_count()},
      {"landmarks", results.map.landmark_count()},
      {"ms",
       {{"frame", ToJson(results.times.frame)},
        {"extract", ToJson(results.times.extract)},
        {"track", ToJson(results.times.track)},
        {"map", ToJson(results.times.map)},
        {"loop", ToJson(results.times.loop)},
        {"detect", ToJson(results.times.detect)},
        {"dynamics", ToJson(results.times.dynamics)},
        {"semidense", ToJson(results.times.semidense)}}},
      {"semidense", SemiDenseJson(setup.settings.slam, results.semidense)},
      {"lens", LensJson(camera.lens)},
      {"cpu_s", log.cpu_s},
      {"wall_s", log.wall_s},
      {"peak_mb", PeakMegabytes()},
      {"dropped_frames", log.dropped},
      {"late_frames", log.late},
      {"warnings", log.warnings},
      {"stopped", StoppedJson(log.health)}};
  // A path may be in any encoding.
  return stats.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace alidade
