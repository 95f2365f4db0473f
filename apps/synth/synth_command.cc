// `alidade synth`: renders a recording with exact ground truth.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/base/parallel.h"
#include "alidade/io/files/file.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/sources/synth_source.h"
#include "alidade/synth/recording.h"
#include "alidade/synth/statistics.h"
#include "commands.h"
#include "program/arguments.h"
#include "synth/synth_folder.h"
#include "synth/synth_writer.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

struct SynthArguments {
  SynthSettings settings;
  std::string out, format;
  int frames = 0;             // 0: once along the path
  int width = 0, height = 0;  // 0: as usual for the scene
  std::optional<double> fov;
  int threads = 0;
  bool quiet = false;
};

ordered_json Describe(const SynthSettings& s) {
  ordered_json told = {
      {"scene", s.scene},   {"frames", s.frames},     {"path", s.path},
      {"speed", s.speed},   {"arm", s.arm},           {"actors", s.actors},
      {"things", s.things}, {"noise", s.noise},       {"light", s.light},
      {"blur", s.blur},     {"exposure", s.exposure}, {"distortion", s.distortion},
      {"k1", s.k1},         {"fisheye", s.fisheye},   {"rolling_shutter", s.rolling_shutter},
      {"stereo", s.stereo}, {"seed", s.seed},         {"width", s.width},
      {"height", s.height}, {"fov", s.fov},           {"fps", s.fps},
      {"held", s.held}};
  if (s.scene == kFlightScene) {
    const auto absolute = [](const std::string& file) {
      return std::filesystem::absolute(file).lexically_normal().string();
    };
    told.erase("fps");
    told["path"] = absolute(s.path);
    if (s.imu != "off") told["imu"] = absolute(s.imu);
    if (!s.imu_model.empty()) told["imu_model"] = absolute(s.imu_model);
  } else if (s.imu != "off") {
    told["imu"] = s.imu;
    told["imu_rate"] = s.ImuRate();
    if (s.imu_offset) told["imu_offset"] = *s.imu_offset;
  }
  return told;
}

ordered_json Describe(const SynthStatistics& s) {
  return {{"path_length_m", s.path_length},     {"median_speed_m_s", s.median_speed},
          {"median_turn_deg_s", s.median_turn}, {"plain_share", s.plain_share},
          {"missing_depth", s.missing_depth},   {"actor_share", s.actor_share}};
}

void Print(const SynthStatistics& s, double fps, const SynthArguments& arguments) {
  std::printf("%s: %d frames (%.1f s) in %s\n", arguments.settings.scene.c_str(), s.frames,
              s.frames / fps, arguments.out.c_str());
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

void CheckImu(const SynthSettings& settings, SynthFormat format) {
  if (settings.imu == "off" || format == SynthFormat::kTum) return;
  if (format == SynthFormat::kKitti)
    ThrowUsage("--imu requires --format tum or euroc: KITTI recordings have no inertial readings");
  if (settings.imu == "phone" || settings.imu_offset)
    ThrowUsage(
        "--imu phone and --imu-offset need --format tum: EuRoC recordings have one clock and a "
        "known sensor");
}

// From shortly before the first frame to shortly after the last.
WrittenImu ReadingsOf(const SynthRecording& recording) {
  constexpr double kAround = 0.1;  // seconds
  const ImuTrack& imu = *recording.imu();
  const double from = recording.Time(0), to = recording.Time(recording.frames() - 1);
  const double offset = imu.truth().time_offset;
  return {imu.told(), imu.Between(from + offset - kAround, to + offset + kAround)};
}

int RenderAll(SynthArguments arguments) {
  SynthSettings& settings = arguments.settings;
  const SynthFormat format = FormatOf(arguments);
  settings.stereo = format != SynthFormat::kTum;  // EuRoC and KITTI recordings are stereo
  const SynthSettings usual = SynthDefaults(settings.scene);
  settings.frames = arguments.frames > 0 ? arguments.frames : usual.frames;
  settings.width = arguments.width > 0 ? arguments.width : usual.width;
  settings.height = arguments.height > 0 ? arguments.height : usual.height;
  settings.fov = arguments.fov.value_or(usual.fov);
  settings.Check();
  CheckThreads(arguments.threads);
  SetThreadCount(arguments.threads);
  if (format == SynthFormat::kKitti && settings.distortion) {
    ThrowUsage("--distortion requires --format tum or euroc: KITTI recordings are rectified");
  }
  if (format != SynthFormat::kTum && settings.fisheye)
    ThrowUsage("--fisheye needs --format tum: the others are stereo");
  CheckImu(settings, format);
  SynthFolder folder(arguments.out);
  const std::string marker = folder.draft() + "/" + kSynthMarker;
  ordered_json about = {{"program", "alidade synth"}, {"settings", Describe(settings)}};

  const SynthRecording recording = MakeSynthRecording(settings);
  const auto writer = MakeSynthWriter(format, folder.draft(), recording.camera(), settings.fisheye);
  const double fps = recording.settings().fps;
  StatisticsCollector statistics(fps);
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
  if (recording.imu() != nullptr) writer->AddReadings(ReadingsOf(recording));
  writer->Finish();
  const SynthStatistics result = statistics.Result();
  about["statistics"] = Describe(result);
  AtomicWriteFile(marker, about.dump(2) + "\n");
  folder.Place();
  if (!arguments.quiet) Print(result, fps, arguments);
  return 0;
}

}  // namespace

void AddSynthCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("synth", "Render a recording with exact poses, depth and masks");
  auto arguments = std::make_shared<SynthArguments>();
  SynthSettings& settings = arguments->settings;
  std::string names;
  for (const std::string& name : SceneNames()) names += name + "|";
  names += kFlightScene;
  command->add_option("SCENE", settings.scene, "Scene to render")->required()->type_name(names);
  command
      ->add_option("OUT", arguments->out,
                   "Folder to write to: new, empty, or written by this command before")
      ->required()
      ->type_name("FOLDER");
  command
      ->add_option(
          "--frames", arguments->frames,
          "Number of frames; default: once along the path of the scene (room 600, street 1080, …)")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  command
      ->add_option(
          "--path", settings.path,
          "Camera motion. walk: the path of the scene; turn: pure rotation; turn-walk: 4 "
          "s of pure rotation, then the path of the scene; still: none. Default: walk. Of a "
          "flight: the file with its poses T_world_camera (TUM, EuRoC or KITTI format)")
      ->type_name("walk|turn|turn-walk|still|FILE");
  command->add_option("--speed", settings.speed,
                      "Speed of the camera relative to the scene's default; default: 1");
  command->add_option(
      "--arm", settings.arm,
      "With --path turn: distance of the camera from the axis of rotation in meters; default: 0");
  command->add_option("--actors", settings.actors, "Number of walking people; default: 0");
  command->add_option(
      "--things", settings.things,
      "Number of cups that are moved by hand, in scenes with a table (room, desk); default: 0");
  command->add_option("--noise", settings.noise,
                      "Standard deviation of the image noise in gray levels; default: 4");
  command->add_option(
      "--light", settings.light,
      "Brightness as a share of daylight: below 0.25 images are dark and noisier; default: 1");
  command->add_flag("--blur{20}", settings.blur,
                    "Motion blur with an exposure time of 20 ms, or of MS with --blur=MS");
  command->add_flag("--exposure", settings.exposure, "Let brightness and contrast drift slowly");
  command->add_flag("--distortion", settings.distortion,
                    "Lens with radial and tangential distortion");
  command->add_option("--k1", settings.k1, "Radial distortion k1 of the lens; default: 0");
  command->add_flag("--fisheye", settings.fisheye, "Equidistant fisheye lens (--format tum only)");
  command->add_flag("--rolling{16}", settings.rolling_shutter,
                    "Rolling shutter with a readout time of 16 ms");
  command->add_option("--rolling-shutter", settings.rolling_shutter,
                      "Rolling shutter with this readout time in milliseconds; default: 0");
  command->add_flag(
      "--stereo", settings.stereo,
      "Add a second camera, 0.11 m to the right (implied by --format euroc and kitti)");
  command
      ->add_option("--format", arguments->format,
                   "Format of the recording; default: tum, with --stereo euroc")
      ->type_name("tum|euroc|kitti");
  command->add_option("--seed", settings.seed,
                      "Seed of textures, clutter, shake, noise and people; default: 1");
  command->add_option("--width", arguments->width,
                      "Width of the images in pixels; default: 640, of a flight 752");
  command->add_option("--height", arguments->height,
                      "Height of the images in pixels; default: 480");
  command->add_option("--fov", arguments->fov,
                      "Horizontal field of view in degrees; default: 62.7, of a flight 78.77");
  command->add_option("--fps", settings.fps, "Frames per second; default: 30");
  command->add_option(
      "--held", settings.held,
      "Share of frames that are late by 0.2 to 1 s, as on a busy phone; default: 0");
  command
      ->add_option("--imu", settings.imu,
                   "Inertial sensor. ideal: without errors; adis: that of the EuRoC drone, fully "
                   "known; phone: biased, with an imprecise clock, and nothing known of it. "
                   "Default: off. Of a flight: the file with its readings, in lines of t [s], "
                   "angular rate [rad/s], specific force [m/s^2]")
      ->type_name("off|adis|phone|ideal|FILE");
  command->add_option("--imu-rate", settings.imu_rate,
                      "Readings of the inertial sensor per second; default: 200, of a phone 60");
  command->add_option("--imu-offset", settings.imu_offset,
                      "Time on the clock of the readings minus that of the images, in "
                      "milliseconds; default: 0, of a phone -30 to 30 by seed");
  command
      ->add_option("--imu-model", settings.imu_model,
                   "Of a flight: the sensor.yaml of its camera (EuRoC), whose T_BS is the pose of "
                   "the camera in the frame of the inertial sensor; default: that of the EuRoC "
                   "drone")
      ->type_name("FILE");
  command->add_option("--threads", arguments->threads, "Threads for rendering; 0: one per core");
  command->add_flag("--quiet", arguments->quiet, "Print errors only");
  command->footer(
      "\nExamples:\n  alidade synth room my_room --frames 300\n  alidade synth corridor people "
      "--actors 3 --blur --format euroc\n  alidade synth flight my_flight --path "
      "groundtruth.txt --imu imu.csv   images along a recorded path\n\n`alidade run` can also "
      "render while it runs, without a "
      "folder: alidade run \"synth:room?frames=300\".");
  command->callback(
      [arguments, &action] { action = [arguments] { return RenderAll(*arguments); }; });
}

}  // namespace alidade
