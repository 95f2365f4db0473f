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
  CLI::App* command =
      app.add_subcommand("export", "Convert a map or a run to a format of other programs");
  const auto options = std::make_shared<ExportOptions>();
  command
      ->add_option("MAP", options->map,
                   "Map file or result folder of `alidade run`; for mcap also a recorded stream")
      ->required()
      ->type_name("PATH");
  command
      ->add_option(
          "OUT", options->out,
          "File to write; for colmap a folder, which must be new, empty or from an earlier export")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--to", options->how.to,
                   "ply, pcd: landmarks; tum: trajectory of the keyframes; colmap: sparse model "
                   "with both; mcap: trajectory, points and, if recorded, the whole run, for "
                   "Foxglove, Lichtblick, Rerun and ros2")
      ->required()
      ->type_name("ply|pcd|tum|colmap|mcap");
  command
      ->add_option("--format", options->how.format,
                   "Number format; default: binary for ply and pcd, text for tum, both for colmap")
      ->type_name("text|binary|both");
  command
      ->add_option(
          "--part", options->how.part,
          "Number of the map, if the file contains several: 0 is the largest (see `alidade info`)")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option(
          "--min-observations", options->how.min_observations,
          "Omit landmarks that fewer keyframes observe; COLMAP's bundle adjuster requires 2")
      ->type_name("N")
      ->capture_default_str();
  command->footer(
      "\nExamples:\n  alidade export alidade-out/kitchen --to ply kitchen.ply\n  alidade export "
      "alidade-out/kitchen --to mcap kitchen.mcap      to open in Foxglove\n  alidade export "
      "map.alidade --to colmap model && colmap model_analyzer --path model");
  command->callback([options, &action] { action = [options] { return ExportCommand(*options); }; });
}

}  // namespace alidade
