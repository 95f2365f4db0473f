#include "run/run_flags.h"

#include <CLI/CLI.hpp>

#include "alidade/io/ros/live/live_source.h"

namespace alidade {
namespace {

constexpr char kExamples[] =
    "\nExamples:\n"
    "  alidade run my_recording                     uses depth or stereo if there is any\n"
    "  alidade run \"synth:desk?seed=3\" --sensor mono\n"
    "  alidade run walk.mp4                         a video: its camera is calibrated first\n"
    "  alidade run walk.mp4 --fov 70 --out walk     a video with a known field of view\n"
    "  alidade run walk.bag                         a ROS recording: .bag, .db3, .mcap or folder\n"
    "  alidade run \"walk.mcap?image=/cam0/image_raw&right=/cam1/image_raw\"   with these topics\n"
    "  alidade run my_recording --viewer            watch the run in a browser\n"
    "  alidade run camera:0 --poses udp:127.0.0.1:5005   tells each pose as it comes\n"
    "  alidade run my_recording --record-to a.mcap  for Foxglove, Lichtblick, Rerun, ros2 bag "
    "play\n"
    "  alidade run my_recording --schedule threaded --profile phone\n"
    "  alidade run my_recording --semidense         also estimates semi-dense depth\n"
    "  alidade run more --load alidade-out/my_recording/map.alidade\n"
    "  alidade run my_recording --set tracker.extractor.features=1500 --first 100 --last 400\n"
    "\nWrites trajectory.txt, keyframes.txt, landmarks.ply, stats.json, report.html and more to "
    "--out;\nwith --semidense also semidense.ply, semidense.png and depth/ "
    "(docs/reference/run-folder.md).";

CLI::Option* AddSource(CLI::App& command, RunOptions& options) {
  return command
      .add_option(
          "SOURCE", options.source,
          "A folder (TUM RGB-D, EuRoC, KITTI, images), a video file, a ROS recording (.bag, .db3, "
          ".mcap or rosbag2 folder; ?image=TOPIC&depth=TOPIC... selects topics), live topics of "
          "ROS 2 (ros2:, likewise), a live camera (camera:0, rtsp://...) or a rendered scene "
          "(synth:SCENE?frames=N&...)")
      ->type_name("PATH");
}

void AddSharedOptions(CLI::App& command, RunOptions& options) {
  command
      .add_option("--sensor", options.sensor,
                  "Which images to use; default: with depth or stereo if the recording has them")
      ->type_name("mono|stereo|rgbd");
  command
      .add_option("--camera", options.camera_file,
                  "Calibration file, used instead of the recording's own: camera.yaml, or that of "
                  "Kalibr, ROS, OpenCV, ORB-SLAM, EuRoC, COLMAP, nerfstudio, RealSense, OAK, "
                  "stella_vslam or Basalt; FILE#NAME chooses one of several cameras")
      ->type_name("FILE");
  command
      .add_option("--fov", options.fov,
                  "Horizontal field of view in degrees, used instead of a calibration; ~70: a "
                  "rough value, with which calibration starts")
      ->type_name("DEGREES");
  command.add_flag(
      "--calibrate-first,!--no-calibrate-first", options.calibrate_first,
      "Estimate an unknown camera from the whole recording before the run (default; one camera "
      "only). Live cameras, and --no-calibrate-first: estimate it during the run");
  command
      .add_option("--profile", options.profile,
                  "desktop: 1000 features per image, full size; phone: 500 features, images 400 "
                  "pixels wide")
      ->type_name("desktop|phone");
  command.add_option("--config", options.config, "YAML file with settings")->type_name("FILE");
  command
      .add_option("--set", options.settings,
                  "Change one setting (`alidade settings` lists them); may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command
      .add_option("--schedule", options.schedule,
                  "inline: every frame is finished before the next one, with the same result each "
                  "time (default for recordings); threaded: mapping runs in separate threads "
                  "(default for live cameras)")
      ->type_name("inline|threaded");
  command
      .add_option("--rate", options.rate,
                  "Playback speed: realtime, max or frames per second; default: max if inline or "
                  "live, realtime if threaded")
      ->type_name("realtime|max|FPS");
  command
      .add_option("--repeat", options.repeat,
                  "Play the recording forward, then backward, this many times")
      ->type_name("N");
  command.add_option("--threads", options.threads, "Threads for parallel loops; 0: one per core")
      ->type_name("N");
  command.add_option("--seed", options.seed, "Seed of all random numbers")->type_name("N");
  command.add_flag("--record", options.record,
                   "Record the run for `alidade view`, as run.stream in the result folder");
  command
      .add_option("--record-to", options.record_to,
                  "Record the run to FILE instead; FILE.mcap: for Foxglove, Rerun and ros2")
      ->type_name("FILE");
  command.add_flag("--viewer", options.viewer,
                   "Show the run in a browser while it is processed, and print the address");
  command
      .add_option("--port", options.port,
                  "Port on which the viewer listens; default: 8090, or the next free one")
      ->type_name("PORT");
  command
      .add_option("--host", options.host,
                  "Address on which the viewer listens; default: 127.0.0.1, reachable from this "
                  "machine only")
      ->type_name("ADDRESS");
  command
      .add_option(
          "--poses", options.poses,
          "Tell each pose as it comes, one line per frame. -: to the standard output, and all "
          "messages to stderr; udp:HOST:PORT: a datagram each. TUM format (time tx ty tz qx qy qz "
          "qw); json:- or json:udp:HOST:PORT: JSON, with covariance and state "
          "(docs/reference/poses.md)")
      ->type_name("-|udp:HOST:PORT");
  command
      .add_option("--out", options.out,
                  options.localize
                      ? "Folder for the results; default: alidade-out/NAME-localized, or "
                        "NAME-localized-2, … if that holds results of another source"
                      : "Folder for the results; default: alidade-out/NAME, or NAME-2, NAME-3, … "
                        "if that holds results of another source")
      ->type_name("FOLDER");
  command.add_flag("--overwrite", options.overwrite,
                   "Replace existing results, even those of another source, of a longer run or of "
                   "a more successful one");
  command
      .add_option("--first", options.first, "Index of the first frame to process, counted from 0")
      ->type_name("N");
  command.add_option("--last", options.last, "Index of the last frame to process")->type_name("N");
  command
      .add_option("--dynamics", options.dynamics,
                  "Moving objects. off: no special treatment; geometry: found by their motion and "
                  "left out; full: also found by a detector; auto (default): off until much of the "
                  "image moves, then geometry")
      ->type_name("auto|off|geometry|full");
  command
      .add_option("--detector", options.detector,
                  "Neural network that detects people and other objects that can move (YOLO, "
                  ".onnx); implies --dynamics full")
      ->type_name("FILE");
  command
      .add_option(
          "--mask", options.mask,
          "Image of the shape of the frames: what is white in it is left out of all of them "
          "(a hood, a gripper, a caption). Without it, what moves with the camera is found "
          "within about a second")
      ->type_name("FILE");
  command
      .add_option("--imu", options.imu,
                  "Inertial readings: a table of them (time, angular rate x y z, acceleration x y "
                  "z); off: use none. Default: those of the recording")
      ->type_name("FILE|off");
  command.add_flag("--write-masks", options.write_masks,
                   "Write the mask of moving objects of each frame to mask/");
  command.add_flag("--quiet", options.quiet, "Print errors only");
}

void AddMapOptions(CLI::App& command, RunOptions& options) {
  command.add_option("--load", options.load, "Continue a saved map (map.alidade) and extend it")
      ->type_name("FILE");
  command.add_flag("--semidense", options.semidense,
                   "Also estimate semi-dense depth, at all pixels with enough gradient; writes "
                   "semidense.ply and depth/");
}

}  // namespace

void AddLocalizeOptions(CLI::App& command, RunOptions& options) {
  options.localize = true;
  AddSource(command, options)->required();
  AddSharedOptions(command, options);
  command
      .add_option("--map", options.load,
                  "Map to localize in (map.alidade), of any camera; it is not changed")
      ->required()
      ->type_name("FILE");
  command
      .add_flag("--semidense", options.semidense, "Not available: localize does not extend the map")
      ->group("");
  command.footer(
      "\nExamples:\n  alidade run monday --out monday_map\n  alidade localize tuesday --map "
      "monday_map/map.alidade --out tuesday\n\nWrites the files of `alidade run` to --out, except "
      "a map. The poses refer to the map's world frame.");
}

void AddRunOptions(CLI::App& command, RunOptions& options) {
  AddSource(command, options)->required();
  AddSharedOptions(command, options);
  AddMapOptions(command, options);
  command.footer(kExamples);
}

void AddPublishedRunOptions(CLI::App& command, RunOptions& options) {
  options.source = kRos2Source;
  AddSource(command, options)->default_str(kRos2Source);
  AddSharedOptions(command, options);
  AddMapOptions(command, options);
}

}  // namespace alidade
