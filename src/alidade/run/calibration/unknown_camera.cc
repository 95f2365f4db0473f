#include "alidade/run/calibration/unknown_camera.h"

#include <cmath>
#include <cstdio>

#include "alidade/base/log.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/sources/any_source.h"

namespace alidade {
namespace {

constexpr const char* kBetter = " (--camera or --fov gives a better value)";

std::string AssumedInWords(const SourceInfo& source) {
  char text[80];
  std::snprintf(text, sizeof(text), "a horizontal field of view of %.1f degrees is assumed",
                FovDegrees(source.camera));
  return source.lens_told.empty() ? text : text + (", from its metadata: " + source.lens_told);
}

void WarnOfDoubt(CameraEstimate estimate, const Camera& taken) {
  estimate.camera = taken;
  LogWarning("the camera is uncertain: the estimated field of view of " + CameraInWords(estimate) +
             " is used" + kBetter);
}

}  // namespace

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
  record.settings.WaryOfTurns();
  if (saved) {
    source.camera = CameraOfSize(*saved, source.camera);
    source.camera.distortion = saved->distortion;
    camera.known = "file";
    camera.focal_sigma = 0;
    if (!told_wary) wary = 0;
    return;
  }
  const bool looked_for = source.sensor == Sensor::kMono && record.calibrate.enabled;
  // estimated during the run
  if (looked_for && (source.kind == "camera" || !options.calibrate_first)) {
    record.settings.FindCamera();
    record.settings.refine.focal_sigma = camera.focal_sigma;
    return;
  }
  if (!looked_for) {
    // a wrong focal length may look like a rolling shutter
    record.settings.readout.enabled = false;
    LogWarning("the camera is unknown: " + AssumedInWords(source) + kBetter);
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
    // a wrong focal length may look like a rolling shutter
    record.settings.readout.enabled = false;
  if (found.estimate.known) {
    camera.known = "estimated";
  } else if (found.usable) {
    WarnOfDoubt(found.estimate, found.estimate.camera);
  } else {
    LogWarning("the camera could not be calibrated: " + found.why_not + "; " +
               AssumedInWords(source) + kBetter);
  }
}

void TakeRefinedCamera(const Slam& slam, RunRecord& record) {
  if (!record.settings.refine.enabled) return;
  CameraFound found;
  found.passes = 1;
  found.frames = record.frames;
  Camera& camera = record.source.camera;
  if (const auto estimate = slam.camera_found()) {
    found.estimate = *estimate;
    found.usable = true;
    camera = CameraOfSize(slam.camera(), camera);
    record.camera.focal_sigma = estimate->focal_sigma;
    if (estimate->known) {
      record.camera.known = "estimated";
    } else {
      WarnOfDoubt(found.estimate, camera);
    }
  } else {
    found.why_not = "the camera moves and rotates too little to determine its focal length";
    LogWarning("the camera could not be calibrated: " + found.why_not + "; " +
               AssumedInWords(record.source) + kBetter);
  }
  found.estimate.camera = camera;
  record.camera.found = std::move(found);
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
