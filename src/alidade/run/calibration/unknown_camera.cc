#include "alidade/run/calibration/unknown_camera.h"

#include <cmath>

#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/map/map_file.h"
#include "alidade/run/sources/any_source.h"

namespace alidade {
namespace {

constexpr const char* kBetter = " (--camera or --fov gives a better value)";

std::string AssumedInWords(const SourceInfo& source, const Camera& camera) {
  char text[80];
  PrintTo(text, sizeof(text), "a horizontal field of view of %.1f degrees is assumed",
          FovDegrees(camera));
  return source.lens_told.empty() ? text : text + (", from its metadata: " + source.lens_told);
}

// The map's camera instead of another calibration of the same one.
void TakeCameraOfMap(const Camera& saved, const SourceInfo& source, CameraFinding& finding) {
  if (source.sensor != Sensor::kMono) return;
  Camera there = CameraOfSize(saved, source.camera);
  const double shift = CameraShift(there, source.camera);
  if (shift < kSameCamera || !MayBeOneCamera(there, source.camera)) return;
  char text[200];
  PrintTo(text, sizeof(text),
          "the camera of the map is used; the calibration of the recording differs from it by %.2g "
          "pixels, which is within its uncertainty",
          shift);
  LogWarning(text);
  there.readout_known = source.camera.readout_known;
  if (there.readout_known) there.readout = source.camera.readout;
  finding.camera = there;
  finding.known = "file";
}

void WarnOfDoubt(CameraEstimate estimate, const Camera& taken) {
  estimate.camera = taken;
  LogWarning("the camera is uncertain: the estimated field of view of " + CameraInWords(estimate) +
             " is used" + kBetter);
}

}  // namespace

CameraFinding LearnCamera(const RunOptions& options, const SourceOptions& wanted,
                          const Camera* saved,
                          const std::function<bool(const CalibrateProgress&)>& go_on,
                          RunSetup& setup) {
  const SourceInfo& source = setup.source;
  SlamSettings& settings = setup.settings.slam;
  CalibrateSettings& calibrate = setup.settings.calibrate;
  CameraFinding finding;
  finding.camera = source.camera;
  if (!source.camera_guessed) {
    finding.known = options.camera_file || options.fov ? "given" : "file";
    if (saved) TakeCameraOfMap(*saved, source, finding);
    return finding;
  }
  finding.known = "assumed";
  if (!source.lens_told.empty()) calibrate.adjust.focal_sigma = calibrate.told_sigma;
  finding.focal_sigma = calibrate.adjust.focal_sigma;
  double& wary = settings.start.two_view.lens_uncertainty;
  const bool told_wary = wary != 0;
  settings.WaryOfTurns();
  if (saved) {
    finding.camera = CameraOfSize(*saved, source.camera);
    finding.camera.distortion = saved->distortion;
    finding.known = "file";
    finding.focal_sigma = 0;
    if (!told_wary) wary = 0;
    return finding;
  }
  const bool looked_for = source.sensor == Sensor::kMono && calibrate.enabled;
  if (looked_for && (source.live || !options.calibrate_first)) {  // during the run
    settings.EnableSelfCalibration();
    settings.refine.focal_sigma = finding.focal_sigma;
    return finding;
  }
  if (!looked_for) {
    settings.readout.enabled = false;  // a wrong lens may be taken for it
    finding.camera.focal_sigma = finding.focal_sigma;
    LogWarning("the camera is unknown: " + AssumedInWords(source, finding.camera) + kBetter);
    return finding;
  }
  const double cpu = ProcessCpuSeconds();
  const Stopwatch clock;
  SourceOptions images = wanted;
  images.imu = kNoImu;
  CameraFound found =
      FindCamera([&] { return OpenAnySource(options.source, images); }, settings, calibrate, go_on);
  found.windows.clear();
  finding.cpu_s = ProcessCpuSeconds() - cpu;
  finding.wall_s = clock.Milliseconds() * 1e-3;
  finding.found = found;
  if (found.usable) {
    finding.camera = found.estimate.camera;
    finding.focal_sigma = found.estimate.focal_sigma;
    if (!told_wary) wary = 3 * finding.focal_sigma;
  }
  finding.camera.focal_sigma = finding.focal_sigma;
  if (!found.estimate.known) settings.readout.enabled = false;  // the lens may be taken for it
  if (found.estimate.known) {
    finding.known = "estimated";
  } else if (found.usable) {
    WarnOfDoubt(found.estimate, found.estimate.camera);
  } else {
    LogWarning("the camera could not be calibrated: " + found.why_not + "; " +
               AssumedInWords(source, finding.camera) + kBetter);
  }
  return finding;
}

void TakeRefinedCamera(const Slam& slam, const RunSetup& setup, int frames,
                       CameraFinding& finding) {
  if (!setup.settings.slam.refine.enabled) return;
  CameraFound found;
  found.passes = 1;
  found.frames = frames;
  Camera& camera = finding.camera;
  if (const auto estimate = slam.camera_found()) {
    found.estimate = *estimate;
    found.usable = true;
    camera = CameraOfSize(slam.camera(), camera);
    finding.focal_sigma = estimate->focal_sigma;
    if (estimate->known) {
      finding.known = "estimated";
    } else {
      WarnOfDoubt(found.estimate, camera);
    }
  } else {
    found.why_not = "the camera moves and rotates too little to determine its focal length";
    LogWarning("the camera could not be calibrated: " + found.why_not + "; " +
               AssumedInWords(setup.source, camera) + kBetter);
  }
  found.estimate.camera = camera;
  finding.found = std::move(found);
}

std::string FoundCameraFile(const CameraFinding& finding, const std::string& source) {
  if (!finding.found || !finding.found->usable) return {};
  const CameraFound& found = *finding.found;
  return FormatCameraFile(found.estimate.camera,
                          "Found by alidade from " + std::to_string(found.estimate.keyframes) +
                              " keyframes of\n" + source + "\nfield of view " +
                              CameraInWords(found.estimate) +
                              (found.estimate.known ? "" : "\nnot known for certain"));
}

}  // namespace alidade
