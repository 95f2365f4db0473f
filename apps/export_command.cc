// `alidade export`: a map as what other programs read.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "alidade/run/export/export_path.h"
#include "commands.h"

namespace alidade {
namespace {

struct ExportOptions {
  std::string map, out;  // paths
  ExportSettings how;
};

int ExportCommand(const ExportOptions& options) {
  const std::string what = ExportPath(options.map, options.how, options.out);
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
      ->add_option("--to", options->how.to,
                   "ply, pcd: the landmarks; tum: the keyframes' trajectory; colmap: a sparse "
                   "model of both; mcap: the run as it was (if it was recorded), its path and "
                   "points, for Foxglove, Lichtblick, Rerun and ros2")
      ->required()
      ->type_name("ply|pcd|tum|colmap|mcap");
  command
      ->add_option("--format", options->how.format,
                   "How numbers are written; by default binary for ply and pcd, text for tum, and "
                   "both for colmap")
      ->type_name("text|binary|both");
  command
      ->add_option("--part", options->how.part,
                   "Which map, when the file holds several: 0 is the largest (see `alidade info`)")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--min-observations", options->how.min_observations,
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
