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

// What is known of the camera, and how it came to be.
struct CameraRecord {
  // given (--camera, --fov), file (beside the recording, or the loaded map's), estimated (found
  // from the recording itself), assumed (66 degrees, or found but not for certain).
  std::string known = "file";
  double focal_sigma = 0;            // standard deviation of the focal length, relative; 0: exact
  std::optional<CameraFound> found;  // when it was looked for
  double cpu_s = 0, wall_s = 0;      // that looking took, seconds
  // Of its rolling shutter, as it was at the end (see Camera); sigma 0: told, or none was found.
  std::array<double, 2> readout{};
  double readout_sigma = 0;
};

struct RunRecord {
  std::string source_path;  // as typed
  SourceInfo source;
  CameraRecord camera;
  SlamSettings settings;
  StreamFeedSettings stream;  // of who tells the run, if somebody does
  LookSettings look;          // of frames without a pose
  LensCheckSettings lens_check;
  CalibrateSettings calibrate;  // of how an unknown camera is found
  std::string profile;

  std::vector<std::string> stamps;              // one per frame that Track() took
  std::vector<int> numbers;                     // their numbers in the recording
  std::optional<double> first_time, last_time;  // of all that came, seconds
  std::map<std::string, int> untracked_reasons;
  UntrackedLog untracked;
  KeyframeAlbum album;
  std::string first_problem;  // of a bad frame
  Trajectory truth;           // of rendered recordings
  LensCheck lens;             // what the map says of it, at the end

  double cpu_s = 0;   // CPU time of all threads, reading images left out, seconds
  double wall_s = 0;  // seconds
  std::vector<std::string> warnings;
  std::exception_ptr failure;  // the source's, that ended the run early
  std::exception_ptr bug;      // what the first frame that failed by no fault of its own threw
  SlamHealth health;           // at the end

  // Small ones side by side, which saves the gaps between larger ones.
  int threads = 0;
  int frames = 0;      // all that came, bad ones included
  int late = 0;        // that gave way to newer ones: not counted in `frames`
  int dropped = 0;     // bad ones
  int incomplete = 0;  // whose depth or right image could not be read
  int dark = 0;        // black ones among those that were not tracked
  bool interrupted = false;
};

// Why nothing could be mapped, to be said to the user.
std::string WhyNothing(const RunRecord& record);

}  // namespace alidade
