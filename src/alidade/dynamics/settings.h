// Settings for excluding moving objects from pose and map.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "alidade/base/api.h"
#include "alidade/detect/settings.h"
#include "alidade/dynamics/belief_settings.h"

namespace ALIDADE_API alidade {

enum class DynamicsMode {
  kOff,  // everything counts as static
  // as kOff until much of the image moves or the poses follow a moving object; then kGeometry
  kAuto,
  kGeometry,  // objects that move relative to the scene are excluded
  kFull       // as kGeometry, and objects of movable classes, also at rest
};

// True if moving objects are excluded from the start: geometry and full.
bool LeavesOutFromStart(DynamicsMode mode);
const char* NameOf(DynamicsMode mode);  // off, auto, geometry, full
// Throws Error (usage) for an unknown word; `what` is the option it was given for.
DynamicsMode DynamicsModeNamed(const std::string& what, const std::string& word);

struct Setting;

// Range, unit and meaning of the named fields: Table() in settings.cc.
struct DynamicsSettings {
  DynamicsMode mode = DynamicsMode::kAuto;

  // With auto, optical flow is compared with the poses in all frames of an unconfirmed map of one
  // camera, and then in watch_frames consecutive frames of each watch_every. Moving objects are
  // excluded from then on
  //   - when, averaged over watch_mean frames, more than a share of the classified tracks moved:
  //   with
  //     one camera watch_moved, while the map is unconfirmed (static scenes 0.02 to 0.42, people
  //     who fill the image 0.8 to 0.96); with stereo watch_moved at any time; with RGB-D, whose
  //     depth tells more, watch_moved_depth at any time (0.02 to 0.13, and 0.83);
  //   - when another motion than that of the poses covers more of the image than votes.rival_share
  //     (ShareOfRivalMotion) in watch_rival_frames frames more than not (static scenes 5 at most,
  //     people 17 and more); in votes.rival_frames in an unconfirmed map of one camera, which is
  //     then started again.
  int watch_frames = 16;
  // Costs a quarter of what geometry costs.
  int watch_every = 64;
  int watch_mean = 10;
  double watch_moved = 0.5;
  double watch_moved_depth = 0.3;
  int watch_rival_frames = 8;
  // With 100 degrees instead of 62, half of the static scene seems to move.
  double watch_lens = 0.1;

  std::string moving_classes =
      "person,cat,dog,horse,sheep,cow,elephant,bear,zebra,giraffe,bird,bicycle,motorcycle,car,bus,"
      "truck,train,boat,airplane";
  std::string carried_classes =
      "chair,backpack,umbrella,handbag,suitcase,sports ball,skateboard,bottle,cup,bowl,laptop,"
      "book,cell phone,teddy bear";

  DetectorSettings detector;

  // A network that takes 0.2 s at 30 frames per second.
  int detector_every_frames = 6;
  int detector_latency_frames = 6;
  // Leaves the processor to tracking and mapping.
  double detector_rest = 0.5;
  double drop_detections = 0;
  double bridge_seconds = 1.0;

  // Switches for individual parts, to measure their contribution.
  bool foreground = true;
  bool geometry = true;
  bool propagate = true;
  bool weigh = true;

  // Thresholds, by part.
  CellDepthSettings depth;
  HistorySettings history;
  FlowVoteSettings votes;
  SurfaceBeliefSettings surfaces;
  TrackBeliefSettings tracks;
  ObjectSettings objects;
  BoxSettings box;
  FeatureBeliefSettings features;
  LandmarkEvidenceSettings landmarks;

  uint64_t seed = 1;  // of random samples; set to the system's seed

  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
