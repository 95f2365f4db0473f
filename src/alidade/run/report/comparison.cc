#include "alidade/run/report/comparison.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/run/folder/result_folder.h"
#include "alidade/run/report/compared_places.h"
#include "alidade/run/results/run_results.h"
#include "alidade/run/sources/truth.h"
#include "alidade/view/comparison.h"

namespace alidade {
namespace {

constexpr char kNone[] = "–";

std::string Figure(const char* format, const std::optional<double>& value) {
  if (!value) return kNone;
  char text[64];
  PrintTo(text, sizeof(text), format, *value);
  return text;
}

// The names of the folders, or their paths if two are equal.
std::vector<std::string> NamesOf(const std::vector<ComparedFolder>& folders) {
  std::vector<std::string> names;
  for (const ComparedFolder& folder : folders) {
    const std::filesystem::path path = std::filesystem::path(folder.path + "/").lexically_normal();
    names.push_back(path.parent_path().filename().string());
  }
  const std::vector<std::string> own = names;
  for (size_t i = 0; i < own.size(); ++i) {
    if (own[i].empty() || own[i] == ".." || std::count(own.begin(), own.end(), own[i]) > 1)
      names[i] = folders[i].path;
    if (!folders[i].name.empty()) names[i] = folders[i].name;
  }
  return names;
}

// The origin of time on the page: common for recordings of the same time, else the start of each.
std::vector<double> StartsOf(const std::vector<ResultFolder>& results) {
  double last_start = results.front().span.first, first_end = results.front().span.last;
  double start = last_start;
  std::vector<double> starts;
  for (const ResultFolder& result : results) {
    starts.push_back(result.span.first);
    start = std::min(start, result.span.first);
    last_start = std::max(last_start, result.span.first);
    first_end = std::min(first_end, result.span.last);
  }
  if (last_start <= first_end) std::fill(starts.begin(), starts.end(), start);
  return starts;
}

std::vector<FateSpan> FatesOf(const ResultFolder& result, double start) {
  const double begin = result.span.first - start, end = result.span.last - start;
  if (!result.first_pose) return {{begin, end, FrameFate::kStarting}};
  std::vector<FateSpan> fates = {{begin, *result.first_pose - start, FrameFate::kStarting},
                                 {*result.first_pose - start, end, FrameFate::kTracked}};
  for (const auto& [from, to] : result.lost_spans)  // drawn on top
    fates.push_back({from - start, to - start, FrameFate::kLost});
  return fates;
}

std::vector<std::pair<std::string, std::string>> MeasuresOf(
    const ResultFolder& result, const std::optional<TruthErrors>& errors) {
  const std::optional<double> coverage =
      result.coverage ? std::optional(100 * *result.coverage) : std::nullopt;
  const std::optional<double> start =
      result.first_pose ? std::optional(*result.first_pose - result.span.first) : std::nullopt;
  const double metres = errors && result.mono() ? errors->ate.T_truth_estimate.s : 1;
  const std::string length = Figure("%.2f", metres * PathLength(result.trajectory)) +
                             (result.mono() && !errors ? " map units" : " m");
  const MedianBar& frame = result.milliseconds.front();
  const bool timed = frame.median >= 0;
  const RpeResult* rpe = errors && errors->rpe ? &*errors->rpe : nullptr;
  return {{"source", result.source},
          {"sensor", result.sensor},
          {"frames", Figure("%.0f", result.frames)},
          {"tracked", Figure("%.0f", result.tracked) + Figure(" (%.1f %%)", coverage)},
          {"starts at frame", Figure("%.0f", result.initialized_at) + Figure(" (%.2f s)", start)},
          {"times lost", std::to_string(result.lost_spans.size())},
          {"keyframes", Figure("%.0f", result.keyframes)},
          {"landmarks", Figure("%.0f", result.landmarks)},
          {"loops", Figure("%.0f", result.loops)},
          {"relocalizations", Figure("%.0f", result.relocalizations)},
          {"maps", Figure("%.0f", result.maps)},
          {"path", result.trajectory.empty() ? kNone : length},
          {"ATE RMSE", errors ? Figure("%.6f m", errors->ate.error.rmse) : kNone},
          {"aligned by", !errors ? kNone
                         : result.mono()
                             ? "Sim(3), scale " + Figure("%.4f", errors->ate.T_truth_estimate.s)
                             : "SE(3)"},
          {"RPE RMSE in 1 s", rpe ? Figure("%.6f m", rpe->trans.rmse) : kNone},
          {"RPE rotation RMSE in 1 s", rpe ? Figure("%.4f°", rpe->rot.rmse) : kNone},
          {"ms per frame, median", timed ? Figure("%.2f", frame.median) : kNone},
          {"ms per frame, p95", timed ? Figure("%.2f", frame.p95) : kNone},
          {"CPU time", result.cpu_s ? Figure("%.2f s", result.cpu_s) : kNone},
          {"peak memory", result.peak_mb ? Figure("%.0f MB", result.peak_mb) : kNone}};
}

}  // namespace

std::string CompareResults(const std::vector<ComparedFolder>& folders) {
  if (folders.size() < 2) ThrowUsage("nothing to compare: give at least two results");
  std::vector<ResultFolder> results;
  results.reserve(folders.size());
  for (const ComparedFolder& folder : folders) results.push_back(ReadResultFolder(folder.path));
  const std::vector<std::string> names = NamesOf(folders);
  const std::vector<double> starts = StartsOf(results);

  RunComparison page;
  page.stages.assign(kResultStages.begin(), kResultStages.end());
  std::vector<std::optional<TruthErrors>> errors(results.size());
  for (size_t i = 0; i < results.size(); ++i) {
    const ResultFolder& result = results[i];
    std::string problem;
    if (!result.truth.empty() && !result.trajectory.empty())
      errors[i] =
          ErrorsAgainst(result.truth, result.trajectory, result.mono(), result.span, &problem);
    if (!problem.empty())
      page.notes.push_back(names[i] + ": no errors against ground truth: " + problem);
  }
  const std::vector<PlacedRuns> places = PlacesOf(results, errors);
  for (size_t i = 0; i < results.size(); ++i) {
    const ResultFolder& result = results[i];
    ComparedRun run;
    run.name = names[i];
    const auto measures = MeasuresOf(result, errors[i]);
    page.measures.clear();
    for (const auto& [measure, value] : measures) {
      page.measures.push_back(measure);
      run.values.push_back(value);
    }
    if (result.trajectory.empty()) page.notes.push_back(names[i] + ": nothing was mapped");
    if (result.maps.value_or(0) > 1)
      page.notes.push_back(names[i] +
                           ": of its maps, the one with the most frames is shown and evaluated");
    run.fates = FatesOf(result, starts[i]);
    if (errors[i]) run.error = ErrorCurve(*errors[i], result.trajectory, starts[i]);
    run.milliseconds = result.milliseconds;
    page.seconds = std::max(page.seconds, result.span.last - starts[i]);
    page.runs.push_back(std::move(run));
  }
  for (const PlacedRuns& placed : places) {
    const size_t first = placed.runs.front();
    ComparedPlace& place = page.places.emplace_back();
    place.runs = placed.runs;
    place.unit = results[first].mono() && !errors[first] ? "map units" : "m";
    if (errors[first]) {
      const TimeSpan& span = results[first].span;
      place.truth = PathOf(Between(results[first].truth, span.first, span.last));
    }
    for (size_t k = 0; k < placed.runs.size(); ++k) {
      const size_t i = placed.runs[k];
      page.runs[i].path = PathOf(results[i].trajectory, placed.T_place_world[k]);
    }
  }
  if (places.size() > 1)
    page.notes.push_back(
        "The runs are of different places or recordings: their paths are drawn side by side, each "
        "at "
        "its own scale");
  return RenderComparison(page);
}

}  // namespace alidade
