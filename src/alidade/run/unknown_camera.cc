#include "alidade/run/unknown_camera.h"

#include <cmath>
#include <cstdio>

#include "alidade/base/log.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/run/any_source.h"
#include "alidade/run/loop.h"

namespace alidade {
namespace {

// Relative uncertainty of a focal length that was assumed (66 degrees along the longer side):
// phones and webcams have 50 to 90. What two views are given to be wary of turns.
constexpr double kGuessedLens = 0.6;

std::string AssumedInWords(const SourceInfo& source) {
  char text[80];
  std::snprintf(text, sizeof(text), "a horizontal field of view of %.1f degrees is assumed",
                FovDegrees(source.camera));
  return source.lens_told.empty() ? text : text + (", by what it says: " + source.lens_told);
}

}  // namespace

void BeWaryOfTurns(SlamSettings& settings) {
  double& wary = settings.start.two_view.lens_uncertainty;
  if (wary == 0) wary = kGuessedLens;
}

void LearnCamera(const RunOptions& options, const SourceOptions& wanted, const Camera* saved,
                 const std::vector<RunWatcher*>& watchers, RunRecord& record) {
  SourceInfo& source = record.source;
  CameraRecord& camera = record.camera;
  if (!source.camera_guessed) {
    camera.known = options.camera_file || options.fov ? "given" : "file";
    return;
  }
  camera.known = "assumed";
  if (!source.lens_told.empty()) record.calibrate.adjust.focal_sigma = record.calibrate.told_sigma;
  camera.focal_sigma = record.calibrate.adjust.focal_sigma;
  double& wary = record.settings.start.two_view.lens_uncertainty;
  const bool told_wary = wary != 0;
  BeWaryOfTurns(record.settings);
  if (saved) {
    source.camera = CameraOfSize(*saved, source.camera);
    source.camera.distortion = saved->distortion;
    camera.known = "file";
    camera.focal_sigma = 0;
    if (!told_wary) wary = 0;
    return;
  }
  const std::string better = " (--camera, or --fov, which is the horizontal one, say better)";
  if (source.sensor != Sensor::kMono || source.kind == "camera" || !options.calibrate_first ||
      !record.calibrate.enabled) {
    record.settings.readout.enabled = false;  // a wrong lens may be taken for it
    LogWarning("nothing is known of the camera: " + AssumedInWords(source) + better);
    return;
  }
  const double cpu = ProcessCpuSeconds();
  const Stopwatch clock;
  CameraFound found = FindCamera([&] { return OpenAnySource(options.source, wanted); },
                                 record.settings, record.calibrate,
                                 [&](const CalibrateProgress& progress) {
                                   for (RunWatcher* watcher : watchers)
                                     watcher->Calibrating(progress);
                                   return !Interrupted();
                                 });
  found.windows.clear();
  camera.cpu_s = ProcessCpuSeconds() - cpu;
  camera.wall_s = clock.Milliseconds() * 1e-3;
  camera.found = found;
  if (found.usable) {
    source.camera = found.estimate.camera;
    camera.focal_sigma = found.estimate.focal_sigma;
    if (!told_wary) wary = 3 * camera.focal_sigma;
  }
  if (!found.estimate.known)
    record.settings.readout.enabled = false;  // the lens may be taken for it
  if (found.estimate.known) {
    camera.known = "estimated";
  } else if (found.usable) {
    LogWarning("the camera is not known for certain: a field of view of " +
               CameraInWords(found.estimate) + " was found and is taken" + better);
  } else {
    LogWarning("the camera stays unknown, as " + found.why_not + ": " + AssumedInWords(source) +
               better);
  }
}

std::string FoundCameraFile(const RunRecord& record) {
  if (!record.camera.found || !record.camera.found->usable) return {};
  const CameraFound& found = *record.camera.found;
  return FormatCameraFile(found.estimate.camera,
                          "Found by alidade from " + std::to_string(found.estimate.keyframes) +
                              " keyframes of\n" + record.source_path + "\nfield of view " +
                              CameraInWords(found.estimate) +
                              (found.estimate.known ? "" : "\nnot known for certain"));
}

}  // namespace alidade
