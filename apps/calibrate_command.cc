// `alidade calibrate`: estimates the camera of uncalibrated recordings.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/io/files/calibrations/write_calibration.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/files/file.h"
#include "alidade/run/calibration/find_camera.h"
#include "alidade/run/calibration/find_imu.h"
#include "alidade/run/calibration/unknown_camera.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/sources/any_source.h"
#include "commands.h"
#include "program/terminal.h"

namespace alidade {
namespace {

struct CalibrateOptions {
  std::vector<std::string> sources;
  std::string camera;  // a calibration to convert instead
  std::string to = "alidade";
  std::string out;
  bool overwrite = false;
  RunOptions run;
};

CalibrationStyle StyleOf(const CalibrateOptions& options) {
  const auto style = CalibrationStyleNamed(options.to);
  if (!style) ThrowUsage("--to must be alidade, kalibr, ros, opencv or colmap, not " + options.to);
  return *style;
}

// First lines of the file, which identify the recordings it was estimated from, or the file it was
// converted from.
std::string HeadOf(const CalibrateOptions& options) {
  if (!options.camera.empty()) return "Converted by alidade calibrate from\n" + options.camera;
  std::string head = "Found by alidade calibrate from";
  for (const std::string& source : options.sources) head += "\n" + source;
  return head;
}

// Refuses to replace a calibration of other recordings, or one written by hand, before any work is
// done.
void CheckIsFree(const CalibrateOptions& options) {
  if (options.overwrite || !IsThere(options.out)) return;
  CheckIsNoResult(options.out);
  std::string head = "# " + HeadOf(options) + (options.camera.empty() ? "\nfield of view" : "\n");
  for (size_t at = 2; (at = head.find('\n', at)) != std::string::npos; at += 3) {
    if (at + 1 < head.size()) head.insert(at + 1, "# ");
  }
  if (IsFile(options.out) && CommentOfCalibration(ReadFile(options.out)).rfind(head, 0) == 0)
    return;
  ThrowInput(options.out +
             " already exists and is not a calibration of these recordings: choose another file "
             "with --out, or replace it with --overwrite");
}

CameraFound Calibrate(const std::string& source, const CalibrateOptions& options,
                      const RunSettings& settings, Terminal& terminal) {
  SourceOptions wanted = SourceOptionsFrom(options.run);
  wanted.sensor = Sensor::kMono;
  const SourceInfo info = OpenAnySource(source, wanted)->Info();
  if (info.live)
    ThrowUsage("calibrate plays a source more than once, which is not possible with " + source);
  if (!info.told.empty() && !options.run.quiet) std::printf("%s\n", info.told.c_str());
  // Ignores a calibration that belongs to the recording: estimating it is the task.
  if (!wanted.fov_degrees) wanted.fov_degrees = AssumedFov({info.camera.width, info.camera.height});
  wanted.fov_rough = true;
  const auto open = [&] { return OpenAnySource(source, wanted); };
  return FindCamera(open, settings.slam, settings.calibrate, [&](const CalibrateProgress& now) {
    if (terminal.shows_progress() && now.frames % 10 == 0) {
      terminal.SetProgress(source + ": pass " + std::to_string(now.pass) + ", frame " +
                           std::to_string(now.frames) +
                           (now.estimate.observations > 0 ? ", " + FovInWords(now.estimate) : ""));
    }
    return !Interrupted();
  });
}

// Estimates one camera from the windows of the last pass over each recording.
CameraEstimate Together(const std::vector<CameraFound>& found, const RunSettings& settings) {
  std::vector<LensWindow> windows;
  const CameraFound* best = nullptr;
  for (const CameraFound& one : found) {
    if (!one.usable) continue;
    if (!best || one.estimate.focal_sigma < best->estimate.focal_sigma) best = &one;
  }
  if (!best) return found.front().estimate;
  for (const CameraFound& one : found) {
    const Camera& size = one.windows_camera;
    if (one.usable && size.width == best->windows_camera.width &&
        size.height == best->windows_camera.height)
      windows.insert(windows.end(), one.windows.begin(), one.windows.end());
  }
  const Camera start = CameraOfSize(best->estimate.camera, best->windows_camera);
  CameraEstimate all =
      EstimateCamera(std::move(windows), start, settings.slam.mapper.noise, settings.calibrate);
  all.camera = CameraOfSize(all.camera, best->estimate.camera);
  return all;
}

// The inertial sensor of the first recording that has one; nullopt: none has, or it was not asked
// for.
std::optional<InertialFinding> CalibrateImu(const CalibrateOptions& options,
                                            const RunSettings& settings, const Camera& camera,
                                            Terminal& terminal) {
  if (options.run.imu == kNoImu) return std::nullopt;
  for (const std::string& source : options.sources) {
    SourceOptions wanted = SourceOptionsFrom(options.run);
    wanted.sensor = Sensor::kMono;
    wanted.fov_degrees = FovDegrees(camera);
    wanted.fov_rough = true;
    std::unique_ptr<FrameSource> opened = OpenAnySource(source, wanted);
    if (!opened->Info().imu) continue;
    InertialFinding found = FindImu(std::move(opened), camera, settings.slam, [&](int frames) {
      if (terminal.shows_progress() && frames % 10 == 0)
        terminal.SetProgress(source + ": inertial sensor, frame " + std::to_string(frames));
      return !Interrupted();
    });
    terminal.SetProgress("");
    if (options.run.quiet) return found;
    std::printf("%s: inertial sensor\n", source.c_str());
    for (const std::string& line : ImuInWords(found)) std::printf("  %s\n", line.c_str());
    return found;
  }
  return std::nullopt;
}

void Write(const Calibration& calibration, const std::string& comment,
           const CalibrateOptions& options, const std::optional<ImuModel>& imu = {}) {
  const WrittenCalibration written = FormatCalibration(calibration, StyleOf(options), comment, imu);
  AtomicWriteFile(options.out, written.text);
  if (options.run.quiet) return;
  if (!written.told.empty()) std::printf("%s\n", written.told.c_str());
  std::printf("Written to %s; to use it: alidade run RECORDING --camera %s\n", options.out.c_str(),
              options.out.c_str());
}

int ConvertCommand(const CalibrateOptions& options) {
  const Calibration calibration = ReadCameraFile(options.camera);
  RequireSize(calibration);
  if (!options.run.quiet && !calibration.told.empty())
    std::printf("%s\n", calibration.told.c_str());
  Write(calibration, HeadOf(options), options);
  return 0;
}

int CalibrateCommand(CalibrateOptions options) {
  CatchInterrupts();
  if (options.out.empty()) options.out = UsualFileName(StyleOf(options));
  if (options.camera.empty() == options.sources.empty())
    ThrowUsage("calibrate needs either recordings or --camera FILE, a calibration to convert");
  CheckIsFree(options);
  if (!options.camera.empty()) return ConvertCommand(options);
  RunSettings settings = SettingsFrom(options.run);
  settings.slam.WaryOfTurns();
  SetThreadCount(options.run.threads);
  Terminal terminal(options.run.quiet);
  std::vector<CameraFound> found;
  for (const std::string& source : options.sources) {
    found.push_back(Calibrate(source, options, settings, terminal));
    terminal.SetProgress("");
    if (Interrupted()) return kInterruptedStatus;
    const CameraFound& one = found.back();
    const Camera &camera = one.estimate.camera, &first = found.front().estimate.camera;
    if (camera.width != first.width || camera.height != first.height) {
      ThrowInput(source + " has images of another size than " + options.sources.front() +
                 ": the recordings are not of one camera, or are cropped differently");
    }
    if (options.run.quiet) continue;
    std::printf("%s: %s\n", source.c_str(),
                one.estimate.known ? CameraInWords(one.estimate).c_str()
                : one.usable
                    ? (CameraInWords(one.estimate) + ", not certain: " + one.why_not).c_str()
                    : ("unknown: " + one.why_not).c_str());
    std::fflush(stdout);
  }
  const CameraEstimate all = found.size() > 1 ? Together(found, settings) : found.front().estimate;
  const bool usable = found.size() > 1 ? all.known : found.front().usable;
  if (!usable) {
    throw Error(ErrorKind::kNothingMapped,
                "the camera could not be calibrated: record near and far objects while moving "
                "sideways and turning (docs/guides/calibration.md)");
  }
  if (found.size() > 1 && !options.run.quiet)
    std::printf("together: %s\n", CameraInWords(all).c_str());
  const std::optional<InertialFinding> imu = CalibrateImu(options, settings, all.camera, terminal);
  if (Interrupted()) return kInterruptedStatus;
  std::optional<ImuModel> model;
  if (imu && imu->solved > 0) model = ObservableOf(*imu);
  Write(
      CalibrationOf(all.camera),
      HeadOf(options) + "\nfield of view " + CameraInWords(all) + (all.known ? "" : "\nuncertain"),
      options, model);
  return 0;
}

}  // namespace

void AddCalibrateCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Estimate a camera and its inertial sensor from recordings, or convert a calibration");
  const auto options = std::make_shared<CalibrateOptions>();
  command
      ->add_option("RECORDING", options->sources,
                   "Recordings of one camera: any source of `alidade run` except live cameras")
      ->type_name("PATH");
  command
      ->add_option(
          "--camera", options->camera,
          "Convert this calibration, of any tool that `alidade run --camera` reads, instead "
          "of estimating one")
      ->type_name("FILE");
  command->add_option("--to", options->to, "Format to write; default: alidade (camera.yaml)")
      ->type_name("alidade|kalibr|ros|opencv|colmap");
  command
      ->add_option("--out", options->out,
                   "Calibration file to write; default: camera.yaml, or the usual name of --to's "
                   "format (camchain.yaml, camera_info.yaml, opencv.yaml, cameras.txt)")
      ->type_name("FILE");
  command->add_flag("--overwrite", options->overwrite,
                    "Replace an existing file, even a calibration of other recordings");
  command
      ->add_option("--fov", options->run.fov,
                   "Horizontal field of view in degrees with which the estimate starts; default: "
                   "66 along the longer side of the image")
      ->type_name("DEGREES");
  command
      ->add_option("--imu", options->run.imu,
                   "Table of inertial readings, whose sensor is calibrated too; default: those of "
                   "the recording; off: none")
      ->type_name("off|FILE");
  command->add_option("--profile", options->run.profile, "As for `alidade run`")
      ->type_name("desktop|phone");
  command
      ->add_option("--first", options->run.first,
                   "Index of the first frame to process, counted from 0")
      ->type_name("N");
  command->add_option("--last", options->run.last, "Index of the last frame to process")
      ->type_name("N");
  command
      ->add_option("--set", options->run.settings,
                   "Change one setting (`alidade settings` lists them); may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("--threads", options->run.threads, "Threads for parallel loops; 0: one per core")
      ->type_name("N");
  command->add_flag("--quiet", options->run.quiet, "Print errors only");
  command->footer(
      "\nNo calibration target is needed: a minute of walking in a furnished room, with sideways "
      "motion\nand turns, is enough. A calibration that belongs to the recording is "
      "ignored.\n\nExamples:\n  alidade calibrate walk.mp4\n  alidade calibrate monday.mp4 "
      "tuesday.mp4 --out phone.yaml\n  alidade run wednesday.mp4 --camera phone.yaml\n  alidade "
      "calibrate "
      "walk.mp4 --to kalibr\n  alidade calibrate --camera camchain.yaml --to ros\n\nExit "
      "status 4: the camera moved or turned too little for an estimate.");
  command->callback(
      [options, &action] { action = [options] { return CalibrateCommand(*options); }; });
}

}  // namespace alidade
