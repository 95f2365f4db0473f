// The camera of a recording that nobody calibrated: played until what was mapped says what focal
// length and distortion it was made with.
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
  CameraEstimate estimate;  // of the recording's images; the camera is the guess where not `usable`
  // Better than the guess, though perhaps not known well enough to say so.
  bool usable = false;
  std::string why_not;              // it is not known: in words
  int passes = 0, frames = 0;       // frames of all passes
  std::vector<LensWindow> windows;  // of the last pass, for pictures of `windows_camera`
  Camera windows_camera;
};

// What is looked on with; may say stop.
struct CalibrateProgress {
  int pass = 0, frames = 0, keyframes = 0;
  CameraEstimate estimate;
};

// `open` gives the recording from its begin on, each time; its camera is where the search starts,
// pinhole with square pixels. `settings`: as the recording will be run; shape is left out.
// `go_on` is asked after each frame. The same result each time with the inline schedule, which is
// used whatever the settings say. Throws what the source throws.
CameraFound FindCamera(const std::function<std::unique_ptr<FrameSource>()>& open,
                       const SlamSettings& settings, const CalibrateSettings& calibrate,
                       const std::function<bool(const CalibrateProgress&)>& go_on);

// `camera` of pictures `width` pixels wide, where they are `of` otherwise: the way back from
// Camera::ScaledToWidth().
Camera CameraOfSize(const Camera& camera, const Camera& of);

double FovDegrees(const Camera& camera);  // horizontal, of the focal length alone
// "56.4 ± 0.3 degrees".
std::string FovInWords(const CameraEstimate& estimate);
// "56.4 ± 0.3 degrees (f 789.7 ± 4.1 px, k1 -0.02 ± 0.01, read in 15.3 ± 0.4 ms)".
std::string CameraInWords(const CameraEstimate& estimate);

}  // namespace alidade
