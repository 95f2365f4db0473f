// All settings of the system in one place. Each is a field; the name in YAML and after --set is its
// path here, e.g. tracker.extractor.features.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/dynamics/settings.h"
#include "alidade/io/frame_source.h"
#include "alidade/looping/settings.h"
#include "alidade/mapping/settings.h"
#include "alidade/place/settings.h"
#include "alidade/semidense/settings.h"
#include "alidade/system/camera_clock.h"
#include "alidade/system/lens_watch.h"
#include "alidade/system/readout_watch.h"
#include "alidade/tracking/mono_start.h"
#include "alidade/tracking/settings.h"

namespace ALIDADE_API alidade {

struct TrajectorySettings {
  // Frames older than this are let go, a few hundred at a time: what a program that runs for days
  // has no use for. 0: every frame is kept, at 16 MB an hour (30 frames per second).
  double keep_seconds = 0;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// Frames that one camera saw before its map could tell where they were, and in its first moments,
// are placed in it later (EarlyFrames).
struct EarlyFrameSettings {
  // Frames kept for it, some 80 kB each; 0: none is placed later. 13 s at 30 Hz, 7 at 60: a drone
  // far from all it sees starts after 6.5 s.
  int most = 400;
  int settle = 60;  // frames after the start, from when on one is placed with each tracked frame
  int most_missed = 10;  // on end that are not recognised, going back: the rest is not tried
  // Cameras do not leap: a frame before the start that lies farther from where those after it lead
  // than this times (the way from the next one, or that of leap_seconds, + 3 standard deviations
  // of its position) is not placed, nor are those before it. What is seen of a map's edge alone can
  // be all at a wrong depth, and agree. Measured in turns: right .05 to 1.15, the first one that is
  // wrong 1.53 to 2.5.
  double max_leap = 1.4;
  // Of the median depth: less is none. Measured: a video at 60 Hz, shaken .016, wrong .023 to .03.
  double min_leap = 0.02;
  // Speed is told over so long at least: phones' videos show each second picture twice.
  double leap_seconds = 0.05;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct SlamSettings {
  Sensor sensor = Sensor::kMono;
  bool threaded = false;  // each stage on its own thread; false: in a fixed order after each frame
  // Pixels; images are scaled down to it. Phone: 400. 0: as they come, but no side longer than
  // max_image_side (0: any): 1920x1080 is worked on in 22 ms on two cores, 4K in 90, and 1000
  // features are no better placed there. A width that is given is taken, however large.
  int image_width = 0;
  int max_image_side = 1920;
  uint64_t seed = 1;  // of every random choice
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
  bool localise = false;  // only find poses in the map that was loaded, and leave it as it is
  // When lost, a new map is started only after so long and so many frames that showed something:
  // with depth it could start at once, and would always be quicker than recognising a place.
  double new_map_seconds = 1.0;
  int new_map_frames = 15;
  int min_map_keyframes = 5;  // a map left with fewer is forgotten

  // "desktop": 1000 features at full size; "phone": 400 pixels wide, 500 features, match counts ×
  // 0.8, semi-dense depth from 5 keyframes. Throws Error (usage) for another name.
  void ApplyProfile(const std::string& profile);
  // The camera is only assumed (66 degrees along the longer side): no map is begun on what a turn
  // with another lens explains, unless the settings say how much to allow for.
  void WaryOfTurns();
  // That, and one camera's lens is found while the map grows. A rolling shutter is looked for with
  // the lens, not on its own: a wrong lens may be taken for it.
  void FindCamera();
  void Check() const;  // throws Error (usage) naming the field that cannot be
  // Whether the colours of images are of use.
  bool WantsColor() const {
    return (semidense.enabled && !localise) || dynamics.mode == DynamicsMode::kFull;
  }

  // Sets one field from text. Throws Error (usage) for an unknown name, with the nearest known one,
  // or a value that is not of its type.
  void Set(const std::string& name, const std::string& value);
  // Every field as (name, value), in order of name.
  std::vector<std::pair<std::string, std::string>> All() const;
};

}  // namespace alidade
