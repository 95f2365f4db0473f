// Offline self-calibration: plays a recording of an uncalibrated camera until the map determines
// focal length and distortion.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "alidade/calibration/camera_estimate.h"
#include "alidade/io/frame_source.h"
#include "alidade/run/setup/calibrate_settings.h"
#include "alidade/system/settings.h"

namespace alidade {

struct CameraFound {
  CameraEstimate estimate;  // for images of the recording's size; the initial guess if not `usable`
  // More accurate than the guess, but possibly not accurate enough to count as known.
  bool usable = false;
  std::string why_not;              // why the camera is not known, in words
  int passes = 0, frames = 0;       // frames: of all passes
  std::vector<LensWindow> windows;  // of the last pass, for images of `windows_camera`
  Camera windows_camera;
};

// Progress of the calibration. The callback may stop it.
struct CalibrateProgress {
  int pass = 0, frames = 0, keyframes = 0;
  CameraEstimate estimate;
};

// `open` opens the recording from its start, for each pass; its camera, a pinhole with square
// pixels, is the initial guess. `settings`: those of the later run; semi-dense mapping is disabled.
// `go_on` is called after each frame. Always uses the inline schedule, so the result is
// reproducible. Throws what the source throws.
CameraFound FindCamera(const std::function<std::unique_ptr<FrameSource>()>& open,
                       const SlamSettings& settings, const CalibrateSettings& calibrate,
                       const std::function<bool(const CalibrateProgress&)>& go_on);

// `camera` for images of size `of`, scaled to images `width` pixels wide: the inverse of
// Camera::ScaledToWidth().
Camera CameraOfSize(const Camera& camera, const Camera& of);

double FovDegrees(const Camera& camera);  // horizontal field of view, from the focal length alone
// "56.4 ± 0.3 degrees".
std::string FovInWords(const CameraEstimate& estimate);
// "56.4 ± 0.3 degrees (f 789.7 ± 4.1 px, k1 -0.02 ± 0.01, read in 15.3 ± 0.4 ms)".
std::string CameraInWords(const CameraEstimate& estimate);

}  // namespace alidade
