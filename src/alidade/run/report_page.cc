#include <cstdio>

#include "alidade/base/timing.h"
#include "alidade/run/run_settings.h"
#include "alidade/run/stats.h"

namespace alidade {
namespace {

std::string Format(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

PlaceDrawing PlaceOf(const RunResults& results, const std::string& unit) {
  PlaceDrawing place;
  place.unit = unit;
  place.path = PathOf(results);
  // The largest map: others lie in worlds of their own.
  const MapResults& map = results.maps.front();
  for (const StampedPose& pose : map.keyframes) {
    place.keyframes.push_back(pose.T_world_camera.t);
  }
  for (LandmarkId id : results.map.Landmarks()) {
    if (results.map.MapOf(results.map.Find(id)->reference) != map.id) continue;
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

std::vector<std::pair<std::string, std::string>> FactsOf(const RunRecord& record,
                                                         const RunResults& results,
                                                         const std::string& unit) {
  const int tracked = results.tracked;
  const double share = record.frames > 0 ? 100.0 * tracked / record.frames : 0;
  std::vector<std::pair<std::string, std::string>> facts = {
      {"source", record.source_path},
      {"sensor", NameOf(record.settings.sensor)},
      {"frames tracked", std::to_string(tracked) + " of " + std::to_string(record.frames) +
                             Format(" (%.1f %%)", share)},
      {"first tracked frame",
       results.initialised_at ? std::to_string(*results.initialised_at) : "none"},
      {"keyframes", std::to_string(results.map.keyframe_count())},
      {"landmarks", std::to_string(results.map.landmark_count())}};
  if (record.settings.semidense.enabled && !record.settings.localise)
    facts.push_back({"keyframes with depth", std::to_string(CountWithDepth(results.map))});
  facts.insert(facts.end(),
               {{"path", Format("%.2f ", PathLength(results.maps.front().trajectory)) + unit},
                {"wall time", Format("%.2f s", record.wall_s)},
                {"CPU time", Format("%.2f s", record.cpu_s)},
                {"peak memory", Format("%.0f MB", PeakMegabytes())}});
  const SlamCounts& counts = results.counts;
  facts.push_back({"loops closed", std::to_string(counts.loops)});
  if (counts.relocalisations > 0)
    facts.push_back({"relocalisations", std::to_string(counts.relocalisations)});
  if (counts.merges > 0) facts.push_back({"maps merged", std::to_string(counts.merges)});
  if (results.maps.size() > 1) {
    facts.push_back({"separate maps", std::to_string(results.maps.size()) +
                                          " (drawn: the one with the most frames)"});
  }
  if (tracked == 0) facts.push_back({"nothing mapped", WhyNothing(record)});
  if (record.dropped > 0) facts.push_back({"frames skipped", std::to_string(record.dropped)});
  if (record.interrupted) facts.push_back({"interrupted", "results as far as it got"});
  return facts;
}

}  // namespace

std::string ReportHtml(const RunRecord& record, const RunResults& results,
                       const std::vector<ReportPicture>& shape) {
  const std::string unit = record.settings.sensor == Sensor::kMono ? "map units" : "m";
  RunReport report;
  report.title = record.source.name;
  report.facts = FactsOf(record, results, unit);
  report.place = PlaceOf(results, unit);
  report.shape = shape;
  report.frames = FatesOf(results.frames);
  report.milliseconds = {{"frame", results.times.frame}, {"extract", results.times.extract},
                         {"track", results.times.track}, {"map", results.times.map},
                         {"loop", results.times.loop},   {"semidense", results.times.semidense}};
  for (const auto& [from, to] : results.lost_spans) {
    report.lost_spans.push_back(Format("%.3f s", from) + Format(" to %.3f s", to));
  }
  report.warnings = record.warnings;
  report.settings = {{"profile", record.profile},
                     {"schedule", record.settings.threaded ? "threaded" : "inline"},
                     {"threads", std::to_string(record.threads)}};
  for (const auto& setting : RunSettings{record.settings, record.stream}.All())
    report.settings.push_back(setting);
  return RenderReport(report);
}

}  // namespace alidade
