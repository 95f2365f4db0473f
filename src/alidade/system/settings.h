// All settings of the system in one place.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/settings_table.h"
#include "alidade/calibration/lens_watch.h"
#include "alidade/calibration/readout_watch.h"
#include "alidade/dynamics/settings.h"
#include "alidade/io/frame_source.h"
#include "alidade/looping/settings.h"
#include "alidade/mapping/settings.h"
#include "alidade/place/settings.h"
#include "alidade/semidense/settings.h"
#include "alidade/system/camera/camera_clock.h"
#include "alidade/tracking/mono_start.h"
#include "alidade/tracking/settings.h"

namespace ALIDADE_API alidade {

// Range, unit and meaning of the fields: the Table() of each struct.
struct TrajectorySettings {
  // Frames take 16 MB an hour at 30 per second.
  double keep_seconds = 0;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

// Deferred localization (EarlyFrames): frames before the start of a monocular map, and its first
// ones, are localized in it later.
struct EarlyFrameSettings {
  // 13 s at 30 Hz; some 80 kB each. A drone far from everything it sees starts after 6.5 s.
  int max_frames = 400;
  int settle_frames = 60;
  int max_missed_frames = 10;
  // Landmarks at the edge of a map can share one depth error and so agree on a wrong pose. Correct
  // jumps are 0.05 to 1.15, wrong ones 1.53 and more (decision 0016-deferred-localization).
  double max_leap = 1.4;
  // Correct ones have 0.016, wrong ones 0.023 and more.
  double min_leap = 0.02;
  // Shortest time, in seconds, over which speed is measured: videos of phones repeat images.
  double leap_seconds = 0.05;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

struct SlamSettings {
  // User-provided: for a struct with a union, clang 14 refuses `const SlamSettings settings;`
  // otherwise.
  SlamSettings() {}

  Sensor sensor = Sensor::kMono;
  bool threaded = false;  // each stage on its own thread; false: in a fixed order after each frame
  // Threaded: the frame after a keyframe waits until that is mapped and its loops are closed, for
  // recordings that are processed as fast as possible: only full adjustments and semi-dense mapping
  // run beside. False: while the mapper lags behind, frames become no keyframes, as with a live
  // camera, whose frames do not wait.
  bool wait_for_mapping = false;
  // 1920 x 1080 takes 22 ms on two cores, 4K takes 90 ms, and 1000 features are no better placed
  // there (decision 0027-image-size-limit).
  int image_width = 0;
  int max_image_side = 1920;
  uint64_t seed = 1;
  TrackerSettings tracker;
  MapperSettings mapper;
  MonoStartSettings start;
  EarlyFrameSettings early;
  PlaceSettings places;
  LoopSettings loop;
  ReadoutSettings readout;
  LensWatchSettings refine;  // of the camera, while the map grows; one camera only
  SemiDenseSettings semidense;
  DynamicsSettings dynamics;
  TrajectorySettings trajectory;
  ClockSettings time;
  union {
    bool localize = false;  // only find poses in the map that was loaded, and leave it as it is
    bool localise [[deprecated("use localize")]];
  };
  bool fixed_parts = true;  // see dynamics/fixed_parts.h
  // With depth a new map could start at once, always sooner than a place is recognized.
  double new_map_seconds = 1.0;
  int new_map_frames = 15;
  int min_map_keyframes = 5;

  // "desktop": 1000 features at full size; "phone": 400 pixels wide, 500 features, match counts ×
  // 0.8, semi-dense depth from 5 keyframes. Throws Error (usage) for another name.
  void ApplyProfile(const std::string& profile);
  // The camera is only assumed (66 degrees along the longer side): no map is begun on what a turn
  // with another lens explains, unless the settings say how much to allow for.
  void WaryOfTurns();
  // That, and online self-calibration of one camera: focal length, distortion and rolling-shutter
  // readout are estimated together while the map grows. The readout alone is not estimated then: a
  // wrong lens can look like it.
  void EnableSelfCalibration();
  [[deprecated("use EnableSelfCalibration()")]] void FindCamera() { EnableSelfCalibration(); }
  static std::span<const Setting> Table();  // of its own fields; Parts() has those of all structs
  void Check() const;                       // throws Error (usage) naming the invalid setting
  // Whether the colors of images are of use.
  bool WantsColor() const {
    return (semidense.enabled && !localize) || dynamics.mode == DynamicsMode::kFull;
  }

  // Every struct with its table.
  std::vector<SettingsPart> Parts();
  // As SetByName() and AllByName() (system/setting_names.h).
  void Set(const std::string& name, const std::string& value);
  std::vector<std::pair<std::string, std::string>> All() const;
};

}  // namespace alidade
