// The camera of a recording that nobody calibrated: played until what was mapped says what focal
// length and distortion it was made with.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/map/camera_estimate.h"
#include "alidade/system/settings.h"

namespace alidade {

struct CalibrateSettings : CameraEstimateSettings {
  // A rolling shutter bends pictures as a wrong lens does: both are looked for at once. Phones and
  // webcams take 10 to 30 ms, others none.
  CalibrateSettings() { readout_sigma = 0.02; }

  bool enabled = true;  // recordings of one camera of which nothing is known are calibrated first
  // A pass ends, and the next one begins with the camera found, when its own differs by more than
  // this (focal length, relative; or as a shift at the picture's corners, of their distance from
  // the middle), and by two standard deviations. A map made with a camera that is far off is bent
  // the more the longer it gets.
  double max_off = 0.06;
  // Standard deviation (relative) of a focal length that is worth to begin anew with: better than
  // what it replaces.
  double max_restart_sigma = 0.02;
  // The same when the recording is at its end and nothing better was found: a map made with a
  // camera that is far off says little of any, but points the right way.
  double max_retry_sigma = 0.1;
  // A search that ends without an answer begins once more with a lens that shifts the picture's
  // corners by this share of their distance from the middle, as wide lenses do. 0: it does not.
  double retry_bend = -0.13;
  // A pass that began with the right camera ends when the focal length's standard deviation is
  // below this, and two estimates on end agree as well: the rest would say little more.
  double enough_sigma = 0.004;
  int max_passes = 6;        // over the recording, at most, of a search
  int first_keyframes = 10;  // of a map when it is asked first, …
  double growth = 1.3;       // … and again whenever it has so many times as many
  // Standard deviation (relative) of a focal length that the recording itself tells (EXIF, what
  // phones write into videos): sensors are cropped for video and against shake.
  double told_sigma = 0.1;
  double max_seconds = 120;  // of the recording, from its begin, that are looked at

  void Check() const;
  // As SlamSettings::Set() and All(); names begin with "calibrate.".
  void Set(const std::string& name, const std::string& value);
  std::vector<std::pair<std::string, std::string>> All() const;
};

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
