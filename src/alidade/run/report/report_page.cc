#include <algorithm>
#include <cstdio>
#include <utility>

#include "alidade/base/print.h"
#include "alidade/base/shell_quoted.h"
#include "alidade/base/timing.h"
#include "alidade/run/report/stats.h"
#include "alidade/run/sources/truth.h"

namespace alidade {
namespace {

std::string Format(const char* format, double value) {
  char text[64];
  PrintTo(text, sizeof(text), format, value);
  return text;
}

// Most landmarks that are drawn, of all maps: more are not visible, but enlarge the page.
constexpr size_t kMostLandmarks = 8000;

constexpr char kOnMapUnits[] =
    "Lengths are in map units: one camera shows shapes, but not their size, so a map unit is the "
    "median depth of the first keyframe. For meters, tell a distance that you know: alidade export "
    "with --scale-by.";

const char* UnitOf(bool meters) { return meters ? "m" : "map units"; }

PlaceDrawing PlaceOf(const RunResults& results, size_t number, const std::string& unit) {
  PlaceDrawing place;
  place.unit = unit;
  place.gravity = results.maps[number].gravity;
  place.path = PathOf(results, number);
  const MapResults& map = results.maps[number];
  for (const StampedPose& pose : map.keyframes) {
    place.keyframes.push_back(pose.T_world_camera.t);
  }
  const size_t step = 1 + static_cast<size_t>(results.map.landmark_count()) / kMostLandmarks;
  size_t counted = 0;
  for (LandmarkId id : results.map.Landmarks()) {  // those of other maps have other world frames
    if (results.map.MapOf(results.map.Find(id)->reference) != map.id) continue;
    if (counted++ % step != 0) continue;
    place.landmarks.push_back(results.R_camera_rectified * results.map.Find(id)->p_world);
  }
  return place;
}

std::vector<FrameFate> FatesOf(const std::vector<FramePose>& frames) {
  std::vector<FrameFate> fates;
  bool started = false;
  for (const FramePose& frame : frames) {
    started = started || frame.tracked;
    fates.push_back(frame.tracked ? FrameFate::kTracked
                    : started     ? FrameFate::kLost
                                  : FrameFate::kStarting);
  }
  return fates;
}

int CountWithDepth(const MapSnapshot& map) {
  int count = 0;
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    count += keyframe.depth != nullptr && !keyframe.depth->pixels.empty();
  }
  return count;
}

// "12 (0.40 s after the start: too little parallax)".
std::string FirstTracked(const RunLog& log, const RunResults& results) {
  if (!results.initialized_at) return "none";
  std::string words = std::to_string(*results.initialized_at);
  const auto first = std::find_if(results.frames.begin(), results.frames.end(),
                                  [](const FramePose& frame) { return frame.tracked; });
  if (first == results.frames.end() || first == results.frames.begin()) return words;
  const double start = results.frames.front().time, waited = first->time - start;
  const std::string why = StartInWords(log.untracked.all(), start, waited);
  return words + Format(", %.2f s after the start", waited) + (why.empty() ? "" : ": " + why);
}

std::string CameraFact(const CameraFinding& camera) {
  if (camera.found && camera.found->usable) {
    return CameraInWords(camera.found->estimate) + ", estimated from the recording" +
           (camera.found->estimate.known ? "" : ", uncertain");
  }
  const std::string fov = Format("%.1f degrees", FovDegrees(camera.camera));
  if (camera.known == "given") return fov + ", as given";
  return fov + (camera.known == "file" ? ", from its calibration" : ", assumed");
}

std::vector<std::pair<std::string, std::string>> FactsOf(const RunSetup& setup,
                                                         const CameraFinding& camera,
                                                         const RunLog& log,
                                                         const RunResults& results,
                                                         const std::string& unit) {
  const int tracked = results.tracked;
  const double share = log.frames > 0 ? 100.0 * tracked / log.frames : 0;
  std::vector<std::pair<std::string, std::string>> facts = {
      {"source", setup.source_path},
      {"sensor", NameOf(setup.settings.slam.sensor)},
      {"camera", CameraFact(camera)},
      {"frames tracked",
       std::to_string(tracked) + " of " + std::to_string(log.frames) + Format(" (%.1f %%)", share)},
      {"first tracked frame", FirstTracked(log, results)},
      {"lost", tracked == 0                 ? "never had a pose"
               : results.lost_spans.empty() ? "never"
                                            : LostInAll(results.lost_spans)},
      {"keyframes", std::to_string(results.map.keyframe_count())},
      {"landmarks", std::to_string(results.map.landmark_count())}};
  if (setup.settings.slam.semidense.enabled && !setup.settings.slam.localize)
    facts.push_back({"keyframes with depth", std::to_string(CountWithDepth(results.map))});
  facts.insert(facts.end(),
               {{"path", Format("%.2f ", PathLength(results.maps.front().trajectory)) + unit},
                {"wall time", Format("%.2f s", log.wall_s)},
                {"CPU time", Format("%.2f s", log.cpu_s)},
                {"peak memory", Format("%.0f MB", PeakMegabytes())}});
  const SlamCounts& counts = results.counts;
  facts.push_back({"loops closed", std::to_string(counts.loops)});
  if (counts.relocalizations > 0)
    facts.push_back({"relocalizations", std::to_string(counts.relocalizations)});
  if (counts.merges > 0) facts.push_back({"maps merged", std::to_string(counts.merges)});
  if (counts.left_out > 0)
    facts.push_back(
        {"left out of every frame", Format("%.0f %% of the image", 100 * counts.left_out)});
  if (results.maps.size() > 1) {
    facts.push_back({"separate maps", std::to_string(results.maps.size()) +
                                          ", which share no place; the first one has the most "
                                          "frames, and the path length is that of it"});
  }
  if (log.dropped > 0) facts.push_back({"frames skipped", std::to_string(log.dropped)});
  return facts;
}

// How far the paths are from the truth, where it is known; each map is laid on it by itself.
void AddErrors(const RunSetup& setup, const RunLog& log, const RunResults& results,
               RunReport& report) {
  if (!log.first_time) return;
  const Trajectory truth = log.truth.empty() ? TruthBeside(setup.source_path) : log.truth;
  if (truth.empty()) return;
  for (size_t i = 0; i < results.maps.size(); ++i) {
    const bool mono = !IsMetric(setup, results.maps[i]);
    const Trajectory& estimate = results.maps[i].trajectory;
    if (estimate.empty()) continue;
    std::string problem;
    const auto errors =
        ErrorsAgainst(truth, estimate, mono, TimeSpan{*log.first_time, *log.last_time}, &problem);
    if (!errors) continue;
    const std::string of = i == 0 ? "" : " of map " + std::to_string(i + 1);
    report.facts.push_back(
        {"ATE RMSE" + of, Format("%.6f m", errors->ate.error.rmse) +
                              (mono ? ", aligned by Sim(3)" : ", aligned by SE(3)")});
    if (errors->rpe) {
      report.facts.push_back({"RPE RMSE in 1 s" + of, Format("%.6f m, ", errors->rpe->trans.rmse) +
                                                          Format("%.4f°", errors->rpe->rot.rmse)});
    }
    report.maps[i].place.truth = PathOf(Between(truth, estimate.front().time, estimate.back().time),
                                        errors->ate.T_truth_estimate.Inverse());
    const Curve curve = ErrorCurve(*errors, estimate, *log.first_time);
    report.error.insert(report.error.end(), curve.begin(), curve.end());
  }
  report.seconds = *log.last_time - *log.first_time;
}

std::vector<ReportMap> MapsOf(const RunSetup& setup, const RunLog& log, const RunResults& results) {
  std::vector<ReportMap> maps;
  const double start = log.first_time.value_or(0);
  for (size_t i = 0; i < results.maps.size(); ++i) {
    const MapResults& map = results.maps[i];
    const std::string unit = UnitOf(IsMetric(setup, map));
    std::string caption = std::to_string(map.trajectory.size()) + " frames";
    if (!map.trajectory.empty()) {
      caption += Format(" from %.2f s", map.trajectory.front().time - start) +
                 Format(" to %.2f s", map.trajectory.back().time - start);
    }
    caption += ", " + std::to_string(map.keyframes.size()) + " keyframes" +
               Format(", path %.2f ", PathLength(map.trajectory)) + unit;
    maps.push_back({caption, PlaceOf(results, i, unit)});
  }
  return maps;
}

// Why the run as a whole failed, and what to do; empty: it did not.
std::vector<std::string> FailureOf(const RunLog& log, const RunResults& results) {
  std::vector<std::string> lines;
  if (results.tracked == 0) {
    const std::string why = WhyNothing(log), advice = AdviceOn(why);
    lines.push_back("Nothing was mapped: " + why + ".");
    if (!advice.empty()) lines.push_back(advice);
  }
  if (log.interrupted) lines.push_back("The run was interrupted: the results are incomplete.");
  return lines;
}

// The options with which the run read its source.
std::string HowRead(const RunSetup& setup) {
  const SourceOptions& reading = setup.reading;
  std::string words;
  if (reading.sensor) words += std::string(" --sensor ") + NameOf(*reading.sensor);
  if (reading.camera_file) words += " --camera " + ShellWord(*reading.camera_file);
  if (reading.fov_degrees)
    words += Format(reading.fov_rough ? " --fov '~%g'" : " --fov %g", *reading.fov_degrees);
  return words;
}

std::vector<ReportStep> NextSteps(const SlamSettings& settings, const RunSetup& setup,
                                  const RunResults& results, const std::string& folder) {
  if (results.tracked == 0 || settings.localize) return {};
  const std::string result = ShellWord(folder);
  std::vector<ReportStep> steps = {{"Walk through the map in a browser", "alidade view " + result}};
  if (!settings.semidense.enabled) {
    steps.push_back({"Map surfaces and edges, not only landmarks",
                     "alidade run " + ShellWord(setup.source_path) + HowRead(setup) +
                         setup.repeat_words + " --semidense"});
  }
  if (setup.settings.slam.sensor != Sensor::kMono) {
    steps.push_back({"Make a colored mesh, which is then shown here", "alidade mesh " + result});
    steps.push_back(
        {"Make a floor grid for a robot's planner, shown here, too", "alidade grid " + result});
  }
  steps.push_back({"Find another recording of the place in this map",
                   "alidade localize RECORDING --map " + ShellWord(folder + "/map.alidade")});
  steps.push_back({"Train Gaussian splats or a radiance field (also: --to colmap, nerfstudio)",
                   "alidade export " + result + " --to gsplat " + ShellWord(folder + "-gsplat")});
  return steps;
}

}  // namespace

std::string ReportHtml(const RunSetup& setup, const CameraFinding& camera, const RunLog& log,
                       const RunResults& results, const std::string& folder,
                       ReportPictures pictures) {
  const bool metric = IsMetric(setup, results.maps.front());
  const std::string unit = UnitOf(metric);
  RunReport report;
  report.title = setup.source.name;
  report.failure = FailureOf(log, results);
  report.unit = unit;
  if (!metric) report.on_units = kOnMapUnits;
  report.next = NextSteps(setup.settings.slam, setup, results, folder);
  report.facts = FactsOf(setup, camera, log, results, unit);
  report.maps = MapsOf(setup, log, results);
  report.cloud = std::move(pictures.shape.scene);
  report.shape = std::move(pictures.shape.pictures);
  if (!report.shape.empty()) {
    report.cloud_picture = std::move(report.shape.front());
    report.shape.erase(report.shape.begin());
  }
  report.keyframes = std::move(pictures.keyframes);
  report.frames = FatesOf(results.frames);
  report.milliseconds = {{"frame", results.times.frame}, {"extract", results.times.extract},
                         {"track", results.times.track}, {"map", results.times.map},
                         {"loop", results.times.loop},   {"semidense", results.times.semidense}};
  report.lost_spans =
      LostInWords(results.lost_spans, log.untracked.all(), log.first_time.value_or(0));
  AddErrors(setup, log, results, report);
  report.warnings = log.warnings;
  report.settings = {{"profile", setup.profile},
                     {"schedule", setup.settings.slam.threaded ? "threaded" : "inline"},
                     {"threads", std::to_string(setup.threads)}};
  for (const auto& setting : setup.settings.All()) report.settings.push_back(setting);
  return RenderReport(report);
}

}  // namespace alidade
