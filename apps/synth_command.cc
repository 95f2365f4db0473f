// `alidade synth`: renders a recording with exact truth.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/base/parallel.h"
#include "alidade/io/files/file.h"
#include "alidade/run/setup/options.h"
#include "alidade/synth/recording.h"
#include "alidade/synth/statistics.h"
#include "commands.h"
#include "program/arguments.h"
#include "synth_folder.h"
#include "synth_writer.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

struct SynthArguments {
  SynthSettings settings;
  std::string out, format;
  int frames = 0;  // 0: once round
  int threads = 0;
  bool quiet = false;
};

ordered_json Describe(const SynthSettings& s) {
  return {{"scene", s.scene},   {"frames", s.frames},     {"path", s.path},
          {"speed", s.speed},   {"arm", s.arm},           {"actors", s.actors},
          {"things", s.things}, {"noise", s.noise},       {"light", s.light},
          {"blur", s.blur},     {"exposure", s.exposure}, {"distortion", s.distortion},
          {"k1", s.k1},         {"fisheye", s.fisheye},   {"rolling_shutter", s.rolling_shutter},
          {"stereo", s.stereo}, {"seed", s.seed},         {"width", s.width},
          {"height", s.height}, {"fov", s.fov},           {"fps", s.fps},
          {"held", s.held}};
}

ordered_json Describe(const SynthStatistics& s) {
  return {{"path_length_m", s.path_length},     {"median_speed_m_s", s.median_speed},
          {"median_turn_deg_s", s.median_turn}, {"plain_share", s.plain_share},
          {"missing_depth", s.missing_depth},   {"actor_share", s.actor_share}};
}

void Print(const SynthStatistics& s, const SynthArguments& arguments) {
  std::printf("%s: %d frames (%.1f s) in %s\n", arguments.settings.scene.c_str(), s.frames,
              s.frames / arguments.settings.fps, arguments.out.c_str());
  std::printf("  path            %.2f m, median speed %.2f m/s\n", s.path_length, s.median_speed);
  std::printf("  median turn     %.1f degrees/s\n", s.median_turn);
  std::printf("  nearly plain    %.1f %% of the image area\n", 100 * s.plain_share);
  std::printf("  missing depth   %.1f %% of the pixels\n", 100 * s.missing_depth);
  std::printf("  people          %.1f %% of the image area\n", 100 * s.actor_share);
}

SynthFormat FormatOf(const SynthArguments& arguments) {
  if (arguments.format.empty())
    return arguments.settings.stereo ? SynthFormat::kEuroc : SynthFormat::kTum;
  const SynthFormat format = Choice<SynthFormat>(
      "--format", arguments.format,
      {{"tum", SynthFormat::kTum}, {"euroc", SynthFormat::kEuroc}, {"kitti", SynthFormat::kKitti}});
  if (format == SynthFormat::kTum && arguments.settings.stereo) {
    ThrowUsage("--stereo: TUM recordings have no second camera (--format euroc or kitti)");
  }
  return format;
}

int RenderAll(SynthArguments arguments) {
  SynthSettings& settings = arguments.settings;
  const SynthFormat format = FormatOf(arguments);
  settings.stereo = format != SynthFormat::kTum;  // EuRoC and KITTI recordings are stereo
  const int natural = SceneFrames(settings.scene);
  if (arguments.frames > 0)
    settings.frames = arguments.frames;
  else
    settings.frames = natural;
  settings.Check();
  CheckThreads(arguments.threads);
  SetThreadCount(arguments.threads);
  if (format == SynthFormat::kKitti && settings.distortion) {
    ThrowUsage(
        "--distortion: KITTI recordings are rectified and cannot say how a lens distorts (--format "
        "tum or euroc)");
  }
  if (format != SynthFormat::kTum && settings.fisheye)
    ThrowUsage("--fisheye needs --format tum: the others are stereo");
  SynthFolder folder(arguments.out);
  const std::string marker = folder.draft() + "/" + kSynthMarker;
  ordered_json about = {{"program", "alidade synth"}, {"settings", Describe(settings)}};

  const SynthRecording recording(settings);
  const auto writer = MakeSynthWriter(format, folder.draft(), recording.camera(), settings.fisheye);
  StatisticsCollector statistics(settings.fps);
  const bool progress = !arguments.quiet && isatty(STDERR_FILENO) != 0;
  for (int i = 0; i < recording.frames(); ++i) {
    const RenderedFrame frame = recording.Render(i);
    const Se3 pose = recording.Pose(i);
    writer->Add(frame, pose);
    statistics.AddPose(pose);
    statistics.AddFrame(frame);
    if (progress && (i % 10 == 9 || i + 1 == recording.frames())) {
      std::fprintf(stderr, "\rrendering %d of %d", i + 1, recording.frames());
    }
  }
  if (progress) std::fprintf(stderr, "\n");
  writer->Finish();
  const SynthStatistics result = statistics.Result();
  about["statistics"] = Describe(result);
  AtomicWriteFile(marker, about.dump(2) + "\n");
  folder.Place();
  if (!arguments.quiet) Print(result, arguments);
  return 0;
}

}  // namespace

void AddSynthCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("synth", "Render a recording with exact poses, depth and masks");
  auto arguments = std::make_shared<SynthArguments>();
  SynthSettings& settings = arguments->settings;
  std::string names;
  for (const std::string& name : SceneNames()) names += (names.empty() ? "" : "|") + name;
  command->add_option("SCENE", settings.scene, "The scene")->required()->type_name(names);
  command
      ->add_option("OUT", arguments->out,
                   "Folder to write to: new, empty, or an earlier recording of this command")
      ->required()
      ->type_name("FOLDER");
  command
      ->add_option("--frames", arguments->frames,
                   "How many; default: once round the scene's path (room 600, street 1080 …)")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--path", settings.path,
                   "walk: the scene's own; turn: on the spot; turn-walk: 4 s on the spot, then "
                   "the scene's own; still: as on a tripod (walk)")
      ->type_name("walk|turn|turn-walk|still");
  command->add_option("--speed", settings.speed, "Times the scene's own (1)");
  command->add_option("--arm", settings.arm,
                      "Meters from the axis to the camera, with --path turn (0)");
  command->add_option("--actors", settings.actors, "People walking about (0)");
  command->add_option("--things", settings.things,
                      "Cups moved about by hand, in scenes with a table: room, desk (0)");
  command->add_option("--noise", settings.noise,
                      "Standard deviation of the image noise, gray levels (4)");
  command->add_option("--light", settings.light,
                      "Share of daylight: below 0.25 pictures are dark; noise shows more (1)");
  command->add_flag("--blur{20}", settings.blur,
                    "Motion blur of a shutter open for 20 ms, or --blur=MS");
  command->add_flag("--exposure", settings.exposure, "Brightness and contrast drift slowly");
  command->add_flag("--distortion", settings.distortion,
                    "A lens with radial and tangential distortion");
  command->add_option("--k1", settings.k1, "A lens with radial distortion alone (0)");
  command->add_flag("--fisheye", settings.fisheye,
                    "An equidistant lens: as many pixels for each degree (--format tum)");
  command->add_flag("--rolling{16}", settings.rolling_shutter,
                    "Rolling shutter, 16 ms from first to last row");
  command->add_option("--rolling-shutter", settings.rolling_shutter,
                      "The same with another number of milliseconds (0)");
  command->add_flag("--stereo", settings.stereo,
                    "A second camera, 0.11 m to the right (implied by euroc and kitti)");
  command->add_option("--format", arguments->format, "Default: tum, with --stereo euroc")
      ->type_name("tum|euroc|kitti");
  command->add_option("--seed", settings.seed, "Of textures, clutter, shake, noise and people (1)");
  command->add_option("--width", settings.width, "Pixels (640)");
  command->add_option("--height", settings.height, "Pixels (480)");
  command->add_option("--fov", settings.fov, "Horizontal field of view, degrees (62.7)");
  command->add_option("--fps", settings.fps, "Frames per second (30)");
  command->add_option("--held", settings.held,
                      "Share of frames that come .2 to 1 s late, as a busy phone's do (0)");
  command->add_option("--threads", arguments->threads, "Threads for rendering; 0 = all cores");
  command->add_flag("--quiet", arguments->quiet, "Say nothing but errors");
  command->footer(
      "\nExamples:\n"
      "  alidade synth room my_room --frames 300\n"
      "  alidade synth corridor people --actors 3 --blur --format euroc\n"
      "\nThe same scene needs no folder at all as a source: alidade run "
      "\"synth:room?frames=300\".");
  command->callback(
      [arguments, &action] { action = [arguments] { return RenderAll(*arguments); }; });
}

}  // namespace alidade
