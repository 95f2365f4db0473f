// What happened in a run, besides the map and the trajectory.
#pragma once

#include <array>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/calibration/find_camera.h"
#include "alidade/run/calibration/lens.h"
#include "alidade/run/recorder/stream_settings.h"
#include "alidade/run/results/keyframe_album.h"
#include "alidade/run/results/untracked.h"
#include "alidade/system/slam.h"

namespace alidade {

// The camera of a run and where it comes from.
struct CameraRecord {
  // given (--camera, --fov), file (of the recording or the loaded map), estimated (from the
  // recording itself), assumed (66 degrees, or an uncertain estimate).
  std::string known = "file";
  double focal_sigma = 0;            // relative standard deviation of the focal length; 0: exact
  std::optional<CameraFound> found;  // if it was calibrated before the run
  double cpu_s = 0, wall_s = 0;      // of that calibration, seconds
  // Rolling-shutter readout time at the end (see Camera); sigma 0: given, or not estimated.
  std::array<double, 2> readout{};
  double readout_sigma = 0;
};

struct RunRecord {
  std::string source_path;  // as typed
  SourceInfo source;
  CameraRecord camera;
  SlamSettings settings;
  StreamFeedSettings stream;  // of the recorder or viewer, if there is one
  LookSettings look;          // for frames without a pose
  LensCheckSettings lens_check;
  CalibrateSettings calibrate;  // for an unknown camera
  std::string profile;

  std::vector<std::string> stamps;              // one per frame that Track() processed
  std::vector<int> numbers;                     // their numbers in the recording
  std::optional<double> first_time, last_time;  // of all frames of the source, seconds
  std::map<std::string, int> untracked_reasons;
  UntrackedLog untracked;
  KeyframeAlbum album;
  std::string first_problem;  // of the first skipped frame
  Trajectory truth;           // of rendered recordings
  LensCheck lens;             // distortion found in the final map

  double cpu_s = 0;   // CPU time of all threads except for reading images, seconds
  double wall_s = 0;  // seconds
  std::vector<std::string> warnings;
  std::exception_ptr failure;  // error of the source that ended the run early
  std::exception_ptr bug;      // exception of the first frame that failed by an internal error
  SlamHealth health;           // at the end

  // Small ones side by side, which saves the gaps between larger ones.
  int threads = 0;
  int frames = 0;   // all frames of the source, unusable ones included
  int late = 0;     // skipped because newer ones were available: not counted in `frames`
  int dropped = 0;  // unusable frames
  int dark = 0;     // black images among the frames without a pose
  bool interrupted = false;
};

// Why nothing could be mapped, as a message to the user.
std::string WhyNothing(const RunRecord& record);

}  // namespace alidade
