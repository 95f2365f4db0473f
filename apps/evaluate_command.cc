// `alidade evaluate`: compares a trajectory with ground truth (depth: evaluate_depth.h).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>

#include "alidade/base/log.h"
#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/rpe.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/sources/truth.h"
#include "commands.h"
#include "evaluate_depth.h"
#include "program/arguments.h"

namespace alidade {
namespace {

using json = nlohmann::ordered_json;  // in the order of docs/reference/evaluation.md

struct EvaluateOptions {
  std::string truth, estimate;  // paths
  std::string align = "auto", association = "tum", delta = "1s", pairs = "all";
  double max_dt = 0.02;
  bool as_json = false;
};

std::filesystem::path Beside(const std::string& path, const char* name) {
  const std::filesystem::path folder(path);
  return (IsFolder(path) ? folder : folder.parent_path()) / name;
}

// Reads a JSON object from the folder of the estimate; empty: there is none.
json NotesBeside(const std::string& estimate, const char* name) {
  const std::string path = Beside(estimate, name).string();
  if (!IsFile(path)) return json::object();
  json notes = json::parse(ReadFile(path), nullptr, /*allow_exceptions=*/false);
  return notes.is_object() ? notes : json::object();
}

// The sensor, as written by `run` or `merge` to that folder; empty: unknown.
std::string SensorOf(const std::string& estimate) {
  for (const char* name : {"stats.json", "merge.json"}) {
    const json notes = NotesBeside(estimate, name);
    if (notes.contains("sensor") && notes["sensor"].is_string())
      return notes["sensor"].get<std::string>();
  }
  return {};
}

// The time span of the recording, as written by `run` to the folder of the trajectory.
std::optional<TimeSpan> SpanFromStats(const std::string& estimate) {
  const json stats = NotesBeside(estimate, "stats.json");
  if (!stats.contains("span")) return std::nullopt;
  const json& span = stats["span"];
  if (!span.is_array() || span.size() != 2 || !span[0].is_number() || !span[1].is_number()) {
    return std::nullopt;
  }
  return TimeSpan{span[0].get<double>(), span[1].get<double>()};
}

// The time span of the images that are listed in the folder of the ground truth, for TUM.
std::optional<TimeSpan> SpanFromImageList(const std::filesystem::path& list_path) {
  if (!IsFile(list_path.string())) return std::nullopt;
  std::istringstream file(ReadFile(list_path.string()));
  std::optional<TimeSpan> span;
  for (std::string line; std::getline(file, line);) {
    char* end = nullptr;
    const double time = std::strtod(line.c_str(), &end);
    if (end == line.c_str()) continue;  // a comment or an empty line
    if (!span) span = TimeSpan{time, time};
    span->first = std::min(span->first, time);
    span->last = std::max(span->last, time);
  }
  return span;
}

// Times of the first and last frame of the recording; nullopt: unknown.
std::optional<TimeSpan> SourceSpan(const EvaluateOptions& options) {
  if (const auto span = SpanFromStats(options.estimate)) return span;
  return SpanFromImageList(Beside(options.truth, "rgb.txt"));
}

json ToJson(const ErrorStatistics& s, double scale, double coverage) {
  return {{"n", s.n},     {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},  {"std", s.std},
          {"min", s.min}, {"max", s.max},   {"scale", scale}, {"coverage", coverage}};
}

void AddAlignment(const ChosenAlignment& chosen, json& all) {
  all["align"] = NameOf(chosen.align);
  all["align_why"] = chosen.why;
}

void PrintRow(const char* name, const ErrorStatistics& s) {
  std::printf("%-12s %11.6f %11.6f %11.6f %11.6f %11.6f %11.6f\n", name, s.rmse, s.mean, s.median,
              s.std, s.min, s.max);
}

void PrintAlignment(const ChosenAlignment& chosen, double scale, const Trajectory& truth,
                    const Trajectory& estimate, const EvaluateOptions& options) {
  std::printf("%s\n\n", InWords(chosen, scale, truth, estimate, options.max_dt).c_str());
}

void PrintHead() {
  std::printf("%-12s %11s %11s %11s %11s %11s %11s\n", "", "rmse", "mean", "median", "std", "min",
              "max");
}

ChosenAlignment AlignmentOf(const EvaluateOptions& options) {
  const std::string sensor = SensorOf(options.estimate);
  if (sensor.empty() && !SensorOf(options.truth).empty()) {
    LogWarning("are the two trajectories swapped? " + options.truth +
               " is a result of `alidade run`, and the ground truth comes first");
  }
  return AlignmentNamed("--align", options.align, sensor);
}

int EvaluateAteCommand(const EvaluateOptions& options) {
  AteSettings settings;
  const ChosenAlignment chosen = AlignmentOf(options);
  settings.align = chosen.align;
  settings.association =
      Choice<Association>("--association", options.association,
                          {{"tum", Association::kTum}, {"evo", Association::kEvo}});
  settings.max_dt = options.max_dt;
  settings.Check();
  settings.source_span = SourceSpan(options);
  const Trajectory truth = ReadTrajectory(options.truth);
  const Trajectory estimate = ReadEstimate(options.estimate);
  const AteResult result = EvaluateAte(truth, estimate, settings);
  if (options.as_json) {
    json all = ToJson(result.error, result.T_truth_estimate.s, result.coverage);
    AddAlignment(chosen, all);
    std::printf("%s\n", all.dump(2).c_str());
    return 0;
  }
  std::printf("absolute trajectory error of %s\n", options.estimate.c_str());
  std::printf("%d of %zu poses matched to the ground truth; coverage %.1f %%\n", result.error.n,
              estimate.size(), 100 * result.coverage);
  PrintAlignment(chosen, result.T_truth_estimate.s, truth, estimate, options);
  PrintHead();
  PrintRow("meters", result.error);
  return 0;
}

void ParseDelta(const std::string& word, RpeSettings& settings) {
  char* end = nullptr;
  settings.delta = std::strtod(word.c_str(), &end);
  const std::string unit = end;
  if (end == word.c_str() || (unit != "s" && unit != "f")) {
    ThrowUsage("--delta cannot be '" + word + "': write seconds like 1s or frames like 30f");
  }
  settings.unit = unit == "s" ? DeltaUnit::kSeconds : DeltaUnit::kFrames;
}

int EvaluateRpeCommand(const EvaluateOptions& options) {
  RpeSettings settings;
  const ChosenAlignment chosen = AlignmentOf(options);
  settings.align = chosen.align;
  settings.pairs = Choice<PairSelection>(
      "--pairs", options.pairs,
      {{"all", PairSelection::kAll}, {"consecutive", PairSelection::kConsecutive}});
  settings.max_dt = options.max_dt;
  ParseDelta(options.delta, settings);
  settings.Check();
  settings.source_span = SourceSpan(options);
  const Trajectory truth = ReadTrajectory(options.truth);
  const Trajectory estimate = ReadEstimate(options.estimate);
  const RpeResult result = EvaluateRpe(truth, estimate, settings);
  if (options.as_json) {
    json both = {{"trans", ToJson(result.trans, result.scale, result.coverage)},
                 {"rot", ToJson(result.rot, result.scale, result.coverage)}};
    AddAlignment(chosen, both);
    std::printf("%s\n", both.dump(2).c_str());
    return 0;
  }
  std::printf("relative pose error of %s over %s\n", options.estimate.c_str(),
              options.delta.c_str());
  std::printf("%d %s pairs; coverage %.1f %%\n", result.trans.n,
              options.pairs == "all" ? "overlapping" : "consecutive", 100 * result.coverage);
  PrintAlignment(chosen, result.scale, truth, estimate, options);
  PrintHead();
  PrintRow("meters", result.trans);
  PrintRow("degrees", result.rot);
  return 0;
}

void AddCommonOptions(CLI::App& command, EvaluateOptions& options) {
  command
      .add_option("GT", options.truth,
                  "Ground truth: a TUM file, a EuRoC csv file, KITTI poses (with times.txt in the "
                  "same folder), or the recording")
      ->required()
      ->type_name("PATH");
  command
      .add_option("EST", options.estimate,
                  "Trajectory to evaluate: a file in one of these formats, or a result folder of "
                  "`alidade run`")
      ->required()
      ->type_name("PATH");
  command
      .add_option("--align", options.align,
                  "Alignment to the ground truth. se3: rotation and translation; sim3: also scale; "
                  "none; auto: sim3 if stats.json of the estimate says one camera, else se3")
      ->type_name("auto|se3|sim3|none")
      ->capture_default_str();
  command
      .add_option("--max-dt", options.max_dt,
                  "Largest difference between the time stamps of a pair of poses")
      ->type_name("SECONDS")
      ->capture_default_str();
  command.add_flag("--json", options.as_json, "Print JSON instead of a table");
}

}  // namespace

void AddEvaluateCommand(CLI::App& app, Action& action) {
  CLI::App* evaluate =
      app.add_subcommand("evaluate", "Compare a trajectory or depth images with ground truth");
  evaluate->require_subcommand(1);
  const auto options = std::make_shared<EvaluateOptions>();

  CLI::App* ate = evaluate->add_subcommand(
      "ate", "Absolute trajectory error (ATE): distance to the ground truth after alignment");
  AddCommonOptions(*ate, *options);
  ate->add_option("--association", options->association,
                  "Pairs of poses. tum: one-to-one, smallest time difference first; evo: the "
                  "nearest for each pose of the shorter trajectory")
      ->type_name("tum|evo")
      ->capture_default_str();
  ate->footer(
      "\nExamples:\n"
      "  alidade evaluate ate rgbd/groundtruth.txt alidade-out/rgbd/trajectory.txt\n"
      "  alidade evaluate ate groundtruth.txt mono.txt --align sim3 --json\n"
      "\nJSON: n, rmse, mean, median, std, min, max (meters), scale, coverage, align, align_why.");
  ate->callback(
      [options, &action] { action = [options] { return EvaluateAteCommand(*options); }; });

  CLI::App* rpe =
      evaluate->add_subcommand("rpe", "Relative pose error (RPE): drift over a fixed interval");
  AddCommonOptions(*rpe, *options);
  rpe->add_option("--delta", options->delta, "Interval, in seconds (1s) or frames (30f)")
      ->type_name("STEP")
      ->capture_default_str();
  rpe->add_option("--pairs", options->pairs,
                  "Intervals that are compared. all: one from each pose, as in the TUM tool; "
                  "consecutive: without overlap")
      ->type_name("all|consecutive")
      ->capture_default_str();
  rpe->footer(
      "\nExamples:\n"
      "  alidade evaluate rpe groundtruth.txt trajectory.txt\n"
      "  alidade evaluate rpe groundtruth.txt trajectory.txt --delta 30f --pairs consecutive\n"
      "\nJSON: trans (meters) and rot (degrees), each as `evaluate ate` prints it.");
  rpe->callback(
      [options, &action] { action = [options] { return EvaluateRpeCommand(*options); }; });

  AddEvaluateDepth(*evaluate, action);
}

}  // namespace alidade
