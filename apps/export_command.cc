// `alidade export`: converts a map or a run for other programs.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/run/export/export_path.h"
#include "alidade/run/play/loop.h"
#include "commands.h"
#include "program/terminal.h"

namespace alidade {
namespace {

struct ExportOptions {
  std::string map, out;  // paths
  bool no_images = false;
  std::vector<std::string> scale_by;
  ExportSettings how;
};

int ExportCommand(const ExportOptions& options) {
  CatchInterrupts();
  ExportSettings how = options.how;
  how.with_images = !options.no_images;
  if (!options.scale_by.empty()) how.scale_by = KnownDistanceOf(options.scale_by);
  Terminal terminal(false);
  const auto progress = [&](int frames, int total) {
    if (terminal.shows_progress() && frames % 10 == 0)
      terminal.SetProgress("frame " + std::to_string(frames) +
                           (total > 0 ? "/" + std::to_string(total) : ""));
    return !Interrupted();
  };
  try {
    const std::string what = ExportPath(options.map, how, options.out, progress);
    terminal.SetProgress("");
    std::printf("%s: %s\n", options.out.c_str(), what.c_str());
    return 0;
  } catch (const ExportStopped&) {
    terminal.SetProgress("");
    return kInterruptedStatus;
  }
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
          "File to write; for colmap, gsplat and nerfstudio a folder, which must be new, empty or "
          "from an earlier export")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--to", options->how.to,
                   "map: a map for --map and --load (to change its unit with --scale-by); ply, "
                   "pcd: landmarks; tum, evo, kitti, euroc: trajectory; colmap: undistorted images "
                   "and a sparse model (images/, sparse/0/); gsplat: the same with the principal "
                   "point in the center, for trainers of Gaussian splats; nerfstudio: images and "
                   "transforms.json; mcap: trajectory, points and, if recorded, the whole run, for "
                   "Foxglove, Lichtblick, Rerun and ros2")
      ->required()
      ->type_name("map|ply|pcd|tum|evo|kitti|euroc|colmap|gsplat|nerfstudio|mcap");
  command
      ->add_option(
          "--images", options->how.images,
          "Which frames become images: keyframes; every:N, each N-th frame; sharpest:RATE, "
          "the sharpest frame of each 1/RATE seconds")
      ->type_name("keyframes|every:N|sharpest:RATE")
      ->capture_default_str();
  command->add_flag("--no-images", options->no_images,
                    "colmap: the model alone, with the recorded, distorted camera");
  command->add_flag("--masks", options->how.masks,
                    "Also masks of moving objects (black), if the run was made with --write-masks");
  command
      ->add_option("--poses", options->how.poses,
                   "Trajectories: of all frames with a pose, or of the keyframes; default: frames "
                   "of a result folder, but keyframes for tum")
      ->type_name("frames|keyframes");
  command
      ->add_option(
          "--up", options->how.up,
          "Which way is up: gravity turns the world so that z is up by the gravity that the "
          "map knows (colmap, gsplat: y is down, as their programs expect); z, for "
          "trajectories: by the mean upright axis of the camera; map: as in the map. "
          "Default: gravity if it is known")
      ->type_name("map|gravity|z");
  command
      ->add_option("--scale-by", options->scale_by,
                   "Maps of one camera: lengths become meters, by two places A and B and the "
                   "distance between them. A place is the time of a frame in seconds "
                   "(trajectory.txt), landmark:ID, or x,y,z in the map")
      ->expected(3)
      ->type_name("A B METERS");
  command->add_flag("--colors", options->how.colors,
                    "ply, pcd: color the landmarks as the recording's images show them");
  command
      ->add_option("--source", options->how.source,
                   "Where the recording is now; default: where the run read it")
      ->type_name("PATH");
  command
      ->add_option("--camera", options->how.camera,
                   "Calibration file of the recording; default: that of the run")
      ->type_name("FILE");
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
      ->add_option("--min-observations", options->how.min_observations,
                   "Omit landmarks that fewer keyframes observe; default: 2 for colmap, gsplat and "
                   "nerfstudio, since COLMAP's bundle adjuster requires 2, else 1")
      ->type_name("N");
  command->footer(
      "\nExamples:\n  alidade export alidade-out/kitchen --to ply kitchen.ply\n  alidade export "
      "alidade-out/kitchen --to pcd kitchen.pcd --colors\n  alidade export alidade-out/kitchen "
      "--to mcap kitchen.mcap      to open in Foxglove\n  alidade export "
      "alidade-out/kitchen --to colmap kitchen-colmap   images and sparse model\n  alidade export "
      "alidade-out/walk --to gsplat walk-gs --images sharpest:2\n  alidade export "
      "alidade-out/walk --to nerfstudio walk-ns --source videos/walk.mp4\n  alidade export "
      "alidade-out/walk --to evo walk.txt --scale-by 2.0 7.5 1.20   in meters: the camera moved "
      "1.20 m\n  alidade export "
      "map.alidade --to colmap model --no-images && colmap model_analyzer --path model");
  command->callback([options, &action] { action = [options] { return ExportCommand(*options); }; });
}

}  // namespace alidade
