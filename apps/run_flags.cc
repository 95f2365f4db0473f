#include "run_flags.h"

#include <CLI/CLI.hpp>

namespace alidade {
namespace {

constexpr char kExamples[] =
    "\nExamples:\n"
    "  alidade run my_recording                     best sensor the recording has\n"
    "  alidade run \"synth:desk?seed=3\" --sensor mono\n"
    "  alidade run walk.mp4                         a video: its camera is found first\n"
    "  alidade run walk.mp4 --fov 70 --out walk     a video, field of view known\n"
    "  alidade run walk.bag                         a ROS recording: .bag, .db3, .mcap or folder\n"
    "  alidade run \"walk.mcap?image=/cam0/image_raw&right=/cam1/image_raw\"   these topics\n"
    "  alidade run my_recording --viewer            watch it in a browser\n"
    "  alidade run my_recording --record-to a.mcap  for Foxglove, Lichtblick, Rerun, ros2 bag "
    "play\n"
    "  alidade run my_recording --schedule threaded --profile phone\n"
    "  alidade run my_recording --semidense         the shape of the place as well\n"
    "  alidade run more --load alidade-out/my_recording/map.alidade\n"
    "  alidade run my_recording --set tracker.extractor.features=1500 --first 100 --last 400\n"
    "\nLeaves trajectory.txt, keyframes.txt, landmarks.ply, stats.json, report.html and more in "
    "--out;\nwith --semidense also semidense.ply, semidense.png and depth/ "
    "(docs/reference/run-folder.md).";

void AddSharedOptions(CLI::App& command, RunOptions& options) {
  command
      .add_option(
          "SOURCE", options.source,
          "Folder (TUM RGB-D, EuRoC, KITTI, images), video file, ROS recording (.bag, .db3, "
          ".mcap, rosbag2 folder; ?image=TOPIC&depth=TOPIC... chooses), camera:0 or "
          "synth:SCENE?frames=N&...")
      ->required()
      ->type_name("PATH");
  command
      .add_option("--sensor", options.sensor,
                  "What to use of the recording; default: the best it has")
      ->type_name("mono|stereo|rgbd");
  command
      .add_option("--camera", options.camera_file,
                  "Calibration (camera.yaml) instead of the recording's own")
      ->type_name("FILE");
  command
      .add_option("--fov", options.fov,
                  "Horizontal field of view, degrees, instead of a calibration; ~70: a guess to "
                  "begin with")
      ->type_name("DEGREES");
  command.add_flag("--calibrate-first,!--no-calibrate-first", options.calibrate_first,
                   "Find a camera that nothing is known of by playing its recording beforehand, as "
                   "long as it takes (on; one camera only); live cameras, and with no-, while the "
                   "map grows");
  command
      .add_option("--profile", options.profile,
                  "desktop (1000 features, full size) or phone (500, 400 pixels wide)")
      ->type_name("desktop|phone");
  command.add_option("--config", options.config, "YAML file of settings")->type_name("FILE");
  command.add_option("--set", options.settings, "One setting; may be given many times")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command
      .add_option("--schedule", options.schedule,
                  "inline (same result every time) or threaded (live); default: inline for "
                  "recordings")
      ->type_name("inline|threaded");
  command
      .add_option("--rate", options.rate,
                  "How fast, FPS in frames per second; default: realtime when threaded")
      ->type_name("realtime|max|FPS");
  command.add_option("--repeat", options.repeat, "Play forth and back this many times")
      ->type_name("N");
  command.add_option("--threads", options.threads, "Threads for parallel loops; 0 = all cores")
      ->type_name("N");
  command.add_option("--seed", options.seed, "Seed of every random choice")->type_name("N");
  command.add_flag("--record", options.record,
                   "Record the run as run.stream among the results, for `alidade view RESULT`");
  command
      .add_option("--record-to", options.record_to,
                  "Record the run to FILE instead; FILE.mcap is for Foxglove, Rerun and ros2")
      ->type_name("FILE");
  command.add_flag("--viewer", options.viewer,
                   "Show the run in a browser while it goes on; prints the address");
  command
      .add_option("--port", options.port,
                  "Port the viewer listens on (8090, or the next that is free)")
      ->type_name("PORT");
  command
      .add_option("--host", options.host,
                  "Address the viewer listens on (127.0.0.1: this machine only)")
      ->type_name("ADDRESS");
  command
      .add_option(
          "--out", options.out,
          options.localize
              ? "Folder for the results (alidade-out/NAME-localized, or -2, -3, … where that "
                "is another source's)"
              : "Folder for the results (alidade-out/NAME, or NAME-2, NAME-3, … where that "
                "is another source's)")
      ->type_name("FOLDER");
  command.add_flag("--overwrite", options.overwrite,
                   "Replace the results in the folder, even those of another source, of a longer "
                   "run, or of one that ended better");
  command.add_option("--first", options.first, "First frame, counted from 0")->type_name("N");
  command.add_option("--last", options.last, "Last frame, included")->type_name("N");
  command
      .add_option("--dynamics", options.dynamics,
                  "auto (as off until much of the picture moves, then as geometry), off, geometry "
                  "(leave out what moves) or full (and what a detector knows to)")
      ->type_name("auto|off|geometry|full");
  command
      .add_option("--detector", options.detector,
                  "Network that finds people and other movers (YOLO, .onnx); implies "
                  "--dynamics full")
      ->type_name("FILE");
  command.add_flag("--write-masks", options.write_masks,
                   "What was left out as moving, a picture for every frame, in mask/");
  command.add_flag("--quiet", options.quiet, "Say nothing but errors");
}

}  // namespace

void AddLocalizeOptions(CLI::App& command, RunOptions& options) {
  options.localize = true;
  AddSharedOptions(command, options);
  command.add_option("--map", options.load, "Map to find poses in (map.alidade); stays as it is")
      ->required()
      ->type_name("FILE");
  command
      .add_flag("--semidense", options.semidense,
                "Of `run` only: nothing is mapped here that could have shape")
      ->group("");
  command.footer(
      "\nExamples:\n"
      "  alidade run monday --out monday_map\n"
      "  alidade localize tuesday --map monday_map/map.alidade --out tuesday\n"
      "\nLeaves the files of `alidade run` in --out, but no map. Poses are in the map's frame.");
}

void AddRunOptions(CLI::App& command, RunOptions& options) {
  AddSharedOptions(command, options);
  command
      .add_option("--load", options.load,
                  "Go on in a saved map (map.alidade) and add to it what is new")
      ->type_name("FILE");
  command.add_flag(
      "--semidense", options.semidense,
      "Map shape too: depth at every pixel with structure, as semidense.ply and depth/");
  command.footer(kExamples);
}

}  // namespace alidade
