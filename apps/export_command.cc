// `alidade export`: a map as what other programs read.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "alidade/io/files/file.h"
#include "alidade/run/mcap_export.h"
#include "alidade/version.h"
#include "arguments.h"
#include "commands.h"
#include "export_folder.h"
#include "map_export.h"

namespace alidade {
namespace {

struct ExportOptions {
  std::string map, out;  // paths
  std::string to, format = "default";
  int part = 0;              // 0: the largest of the maps in the file
  int min_observations = 1;  // landmarks fewer keyframes see are left out
};

enum class Target { kPly, kPcd, kTum, kColmap, kMcap };
enum class Form { kDefault, kText, kBinary, kBoth };

struct Plan {
  Target target;
  Form form;
};

// What the words ask for, with `default` made definite.
Plan PlanOf(const ExportOptions& options) {
  const auto target = Choice<Target>("--to", options.to,
                                     {{"ply", Target::kPly},
                                      {"pcd", Target::kPcd},
                                      {"tum", Target::kTum},
                                      {"colmap", Target::kColmap},
                                      {"mcap", Target::kMcap}});
  auto form = Choice<Form>("--format", options.format,
                           {{"text", Form::kText},
                            {"binary", Form::kBinary},
                            {"both", Form::kBoth},
                            {"default", Form::kDefault}});
  if (target == Target::kTum && form != Form::kDefault && form != Form::kText) {
    ThrowUsage("--format cannot be '" + options.format + "': TUM trajectories are text");
  }
  if (target != Target::kColmap && form == Form::kBoth) {
    ThrowUsage("--format both is for --to colmap, whose model is a folder");
  }
  if (target == Target::kMcap && form != Form::kDefault && form != Form::kBinary) {
    ThrowUsage("--format cannot be '" + options.format + "': MCAP is binary");
  }
  if (form == Form::kDefault) form = target == Target::kColmap ? Form::kBoth : Form::kBinary;
  return {target, form};
}

MapPart PartOf(const SavedMap& saved, const ExportOptions& options) {
  const std::vector<MapPart> parts = PartsOf(saved.map);
  if (parts.empty() && options.part == 0) return {};
  if (options.part < 0 || static_cast<size_t>(options.part) >= parts.size()) {
    ThrowUsage("--part " + std::to_string(options.part) +
               ": maps are numbered from 0, and here are " + std::to_string(parts.size()));
  }
  return parts[static_cast<size_t>(options.part)];
}

void WriteExportFile(const std::string& path, const std::string& bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    ThrowInput(path + " is a folder; name the file to write");
  }
  AtomicWriteFile(path, bytes);
}

// A recorded stream, results or a map.
int ExportToMcap(const ExportOptions& options) {
  const std::string stream = StreamIn(options.map), program = "alidade " ALIDADE_VERSION;
  std::error_code error;
  if (std::filesystem::equivalent(stream.empty() ? options.map : stream, options.out, error))
    ThrowUsage("OUT is what is exported; name another");
  const bool map = stream.empty() && !IsFolder(options.map);
  if (!map && (options.part != 0 || options.min_observations != 1)) {
    ThrowUsage("--part and --min-observations choose from a map: name the file map.alidade");
  }
  McapCounts counts;
  if (map) {
    const SavedMap saved = ReadSavedMap(options.map);
    const MapPart part = SeenOften(saved, PartOf(saved, options), options.min_observations);
    counts = ExportMap(saved, part, options.out, program);
  } else if (stream.empty()) {
    counts = ExportResults(options.map, options.out, program);
  } else {
    counts = ExportStream(stream, options.out, program);
  }
  const std::string shape =
      counts.shape > 0 ? ", " + std::to_string(counts.shape) + " points of shape" : "";
  std::printf("%s: %d %s, %zu landmarks%s, %.1f MB\n", options.out.c_str(), counts.frames,
              map ? "keyframes" : "frames", counts.landmarks, shape.c_str(),
              1e-6 * static_cast<double>(counts.bytes));
  return 0;
}

int ExportCommand(const ExportOptions& options) {
  const Plan plan = PlanOf(options);
  if (plan.target == Target::kMcap) return ExportToMcap(options);
  std::error_code error;
  if (std::filesystem::equivalent(SavedMapPath(options.map), options.out, error)) {
    ThrowUsage("OUT is the map itself; name another");
  }
  const SavedMap saved = ReadSavedMap(options.map);
  const MapPart part = SeenOften(saved, PartOf(saved, options), options.min_observations);
  const auto cloud_format = plan.form == Form::kText ? CloudFormat::kAscii : CloudFormat::kBinary;
  std::string what = std::to_string(part.landmarks.size()) + " points";
  switch (plan.target) {
    case Target::kPly:
      WriteExportFile(options.out, EncodePly(CloudOf(saved, part), cloud_format));
      break;
    case Target::kPcd:
      WriteExportFile(options.out, EncodePcd(CloudOf(saved, part), cloud_format));
      break;
    case Target::kTum:
      WriteExportFile(options.out, FormatTumTrajectory(TrajectoryOf(saved, part)));
      what = std::to_string(part.keyframes.size()) + " poses";
      break;
    case Target::kColmap: {
      const ColmapModel model = ColmapModelOf(saved, part);
      std::vector<ColmapFile> files;
      if (plan.form != Form::kBinary) files = EncodeColmapText(model);
      if (plan.form != Form::kText) {
        for (ColmapFile& file : EncodeColmapBinary(model)) files.push_back(std::move(file));
      }
      WriteExportFolder(options.out, files);
      what = std::to_string(part.keyframes.size()) + " images, " + what;
      break;
    }
    case Target::kMcap:  // above
      break;
  }
  std::printf("%s: %s\n", options.out.c_str(), what.c_str());
  return 0;
}

}  // namespace

void AddExportCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("export", "A map, or a run, as what other programs read");
  const auto options = std::make_shared<ExportOptions>();
  command
      ->add_option("MAP", options->map,
                   "The map: a file, or the folder `run` left (for mcap also a recorded stream)")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("OUT", options->out,
                   "File to write; for colmap a folder, new, empty or of an earlier export")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--to", options->to,
                   "ply, pcd: the landmarks; tum: the keyframes' trajectory; colmap: a sparse "
                   "model of both; mcap: the run as it was (if it was recorded), its path and "
                   "points, for Foxglove, Lichtblick, Rerun and ros2")
      ->required()
      ->type_name("ply|pcd|tum|colmap|mcap");
  command
      ->add_option("--format", options->format,
                   "How numbers are written; by default binary for ply and pcd, text for tum, and "
                   "both for colmap")
      ->type_name("text|binary|both");
  command
      ->add_option("--part", options->part,
                   "Which map, when the file holds several: 0 is the largest (see `alidade info`)")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--min-observations", options->min_observations,
                   "Leave out landmarks that fewer keyframes see; COLMAP's own bundle adjuster "
                   "wants 2")
      ->type_name("N")
      ->capture_default_str();
  command->footer(
      "\nExamples:\n"
      "  alidade export alidade-out/kitchen --to ply kitchen.ply\n"
      "  alidade export alidade-out/kitchen --to mcap kitchen.mcap      open it in Foxglove\n"
      "  alidade export map.alidade --to colmap model && colmap model_analyzer --path model");
  command->callback([options, &action] { action = [options] { return ExportCommand(*options); }; });
}

}  // namespace alidade
