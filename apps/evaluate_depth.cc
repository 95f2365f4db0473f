#include "evaluate_depth.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/evaluation/depth_error.h"
#include "depth_folder.h"
#include "program/arguments.h"
#include "true_depth.h"

namespace alidade {
namespace {

using json = nlohmann::ordered_json;  // in the order of docs/reference/evaluation.md

struct Options {
  std::string sequence, result;  // as typed
  std::string scale = "auto";
  std::optional<std::string> camera_file;
  double max_dt = 0.02;  // seconds
  bool as_json = false;
};

struct Evaluation {
  bool rendered = false;  // the ground truth is exact
  bool fit_scale = false;
  std::vector<DepthFile> files;  // those that were scored
  DepthErrorResult result;

  // The main scores. Depth of a sensor is reliable only where it is continuous.
  const DepthScore& Main(const DepthScores& scores) const {
    return rendered ? scores.all : scores.continuous;
  }
};

bool FitsScale(const Options& options, const DepthFolder& folder) {
  enum class Scale { kAuto, kFit, kNone };
  const Scale scale =
      Choice<Scale>("--scale", options.scale,
                    {{"auto", Scale::kAuto}, {"fit", Scale::kFit}, {"none", Scale::kNone}});
  if (scale != Scale::kAuto) return scale == Scale::kFit;
  if (!folder.sensor) {
    ThrowInput(options.result +
               "/stats.json does not say which sensor the map was made with: use --scale fit for "
               "one camera, else --scale none");
  }
  return *folder.sensor == Sensor::kMono;
}

void WarnLeftOut(size_t left_out, size_t listed, const std::string& why) {
  if (left_out == 0) return;
  LogWarning(std::to_string(left_out) + " of " + std::to_string(listed) + " keyframes " + why +
             ": left out");
}

Evaluation Evaluate(const Options& options) {
  if (!(options.max_dt > 0)) ThrowUsage("--max-dt must be a positive number of seconds");
  const DepthFolder folder = ReadDepthFolder(options.result);
  Evaluation evaluation;
  evaluation.fit_scale = FitsScale(options, folder);
  TrueDepthSource truth(options.sequence, folder.sensor, options.camera_file);
  evaluation.rendered = truth.rendered();
  DepthErrorSettings settings;
  settings.fit_scale = evaluation.fit_scale;
  DepthScorer scorer(settings);
  size_t without_frame = 0, without_truth = 0;
  for (const DepthFile& file : folder.files) {
    const cv::Mat estimate = ReadKeyframeDepth(file.path);
    const auto frame = truth.At(file.time, options.max_dt);
    without_frame += !frame;
    without_truth += frame && frame->depth.empty();
    if (!frame || frame->depth.empty()) continue;
    try {
      scorer.Add({estimate, frame->depth, frame->image, file.map});
    } catch (const Error& error) {
      ThrowInput(file.path + ": " + error.what());
    }
    evaluation.files.push_back(file);
  }
  const size_t listed = folder.files.size();
  if (listed > 0 && without_frame == listed) {
    ThrowInput("no keyframe of " + options.result + " has the time of a frame of " +
               options.sequence + " (first: " + folder.files.front().stamp +
               "): are they of the same recording?");
  }
  if (listed > 0 && evaluation.files.empty())
    ThrowInput(options.sequence + " has no depth for any keyframe of " + options.result);
  WarnLeftOut(without_frame, listed, "have no frame of the same time in the sequence");
  WarnLeftOut(without_truth, listed, "have no true depth");
  evaluation.result = scorer.Result();
  return evaluation;
}

// Unknown values (NaN) are printed as null.
json ToJson(const DepthScore& s) {
  return {{"n", s.n},
          {"median_rel", s.median_rel},
          {"p90_rel", s.p90_rel},
          {"within_2", s.within_2},
          {"within_5", s.within_5},
          {"within_10", s.within_10},
          {"rmse_inv", s.rmse_inv},
          {"density", s.density},
          {"density_gradient", s.density_gradient},
          {"edge_coverage", s.edge_coverage},
          {"scale", s.scale}};
}

json ToJson(const Evaluation& evaluation) {
  const DepthErrorResult& result = evaluation.result;
  json out = ToJson(evaluation.Main(result.overall));
  out["truth"] = evaluation.rendered ? "rendered" : "sensor";
  out["pixels"] = evaluation.rendered ? "all" : "continuous";
  out["scales"] = result.scales;
  out["all"] = ToJson(result.overall.all);
  out["continuous"] = ToJson(result.overall.continuous);
  out["keyframes"] = json::array();
  for (size_t i = 0; i < evaluation.files.size(); ++i) {
    json keyframe = {{"stamp", evaluation.files[i].stamp}, {"map", evaluation.files[i].map}};
    keyframe.update(ToJson(evaluation.Main(result.frames[i])));
    out["keyframes"].push_back(keyframe);
  }
  return out;
}

std::string Percent(double share) {
  if (share != share) return "-";
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", 100 * share);
  return text;
}

void PrintHead(const char* name) {
  std::printf("%-18s %9s %7s %7s %7s %7s %7s %9s %8s %8s %8s\n", name, "pixels", "median", "90 %",
              "to 2 %", "to 5 %", "to 10 %", "rmse 1/m", "density", "of grad.", "of edges");
}

void PrintRow(const std::string& name, const DepthScore& s) {
  char rmse[32] = "-";
  if (s.n > 0) std::snprintf(rmse, sizeof(rmse), "%.5f", s.rmse_inv);
  std::printf("%-18s %9lld %7s %7s %7s %7s %7s %9s %8s %8s %8s\n", name.c_str(),
              static_cast<long long>(s.n), Percent(s.median_rel).c_str(),
              Percent(s.p90_rel).c_str(), Percent(s.within_2).c_str(), Percent(s.within_5).c_str(),
              Percent(s.within_10).c_str(), rmse, Percent(s.density).c_str(),
              Percent(s.density_gradient).c_str(), Percent(s.edge_coverage).c_str());
}

std::string DescribeScales(const Evaluation& evaluation, const Options& options) {
  const std::string why = options.scale != "auto" ? "--scale"
                          : evaluation.fit_scale  ? "one camera"
                                                  : "depth or stereo";
  if (!evaluation.fit_scale) return "not scaled (" + why + ")";
  std::string text = "scaled (" + why + ") by";
  for (const double scale : evaluation.result.scales) {
    char number[32];
    std::snprintf(number, sizeof(number), " %.6f", scale);
    text += number;
  }
  return text + " (median of truth / estimate, over all pixels of a map)";
}

void PrintTable(const Evaluation& evaluation, const Options& options) {
  const DepthErrorResult& result = evaluation.result;
  std::printf("semi-dense depth of %s, against %s\n", options.result.c_str(),
              evaluation.rendered ? "exact (rendered) depth" : "depth of a sensor");
  std::printf("%zu keyframes, %s; relative errors and shares in %%\n\n", evaluation.files.size(),
              DescribeScales(evaluation, options).c_str());
  PrintHead("");
  PrintRow("all pixels", result.overall.all);
  PrintRow("depth-continuous", result.overall.continuous);
  if (evaluation.files.empty()) return;
  std::printf("\n%s of each keyframe\n",
              evaluation.rendered ? "all pixels" : "depth-continuous pixels");
  PrintHead("time");
  for (size_t i = 0; i < evaluation.files.size(); ++i)
    PrintRow(evaluation.files[i].stamp, evaluation.Main(result.frames[i]));
}

}  // namespace

void AddEvaluateDepth(CLI::App& evaluate, Action& action) {
  CLI::App* depth = evaluate.add_subcommand(
      "depth", "Compare semi-dense depth with rendered depth or a depth sensor");
  const auto options = std::make_shared<Options>();
  depth
      ->add_option("SEQUENCE", options->sequence,
                   "The recording with its depth: a TUM RGB-D folder, a folder written by `alidade "
                   "synth`, or synth:SCENE?...")
      ->required()
      ->type_name("PATH");
  depth
      ->add_option("RESULT", options->result,
                   "Result folder of `alidade run SEQUENCE --semidense`, which contains depth.txt")
      ->required()
      ->type_name("FOLDER");
  depth
      ->add_option("--scale", options->scale,
                   "fit: scale each map by the median of truth / estimate; none; auto: fit for one "
                   "camera, else none")
      ->type_name("auto|fit|none")
      ->capture_default_str();
  depth
      ->add_option("--camera", options->camera_file,
                   "Calibration file, used instead of the sequence's own, as for `run`")
      ->type_name("FILE");
  depth
      ->add_option("--max-dt", options->max_dt,
                   "Largest difference between the time stamps of a pair of images")
      ->type_name("SECONDS")
      ->capture_default_str();
  depth->add_flag("--json", options->as_json, "Print JSON instead of a table");
  depth->footer(
      "\nExamples:\n  alidade run kitchen --sensor mono --semidense --out result\n  alidade "
      "evaluate depth kitchen result\n  alidade evaluate depth \"synth:room?seed=3\" "
      "alidade-out/synth-room --json\n\nJSON: n, median_rel, p90_rel, within_2, within_5, "
      "within_10, rmse_inv (1/m), density,\ndensity_gradient, edge_coverage, scale: for all pixels "
      "if the true depth is rendered, for pixels with\ncontinuous depth if it is a sensor's. `all` "
      "and `continuous` have both, `keyframes` those of each keyframe.");
  depth->callback([options, &action] {
    action = [options] {
      const Evaluation evaluation = Evaluate(*options);
      if (options->as_json) {
        std::printf("%s\n", ToJson(evaluation).dump(2).c_str());
      } else {
        PrintTable(evaluation, *options);
      }
      return 0;
    };
  });
}

}  // namespace alidade
