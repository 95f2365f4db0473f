// Settings of what keeps moving things out of pose and map.
#pragma once

#include <cstdint>
#include <string>

#include "alidade/base/api.h"
#include "alidade/detect/settings.h"
#include "alidade/dynamics/belief_settings.h"

namespace ALIDADE_API alidade {

enum class DynamicsMode {
  kOff,       // everything is taken to stand still
  kAuto,      // the same, until much moves or the poses follow what does; then kGeometry
  kGeometry,  // what moves against the rest is left out
  kFull       // and so is what a detector knows to move by itself, even while it rests
};

// Whether what moves is left out whatever is seen: geometry and full.
bool LeavesOutFromStart(DynamicsMode mode);
const char* NameOf(DynamicsMode mode);  // off, auto, geometry, full
// Throws Error (usage) for a word that names none; `what` is whose word it is.
DynamicsMode DynamicsModeNamed(const std::string& what, const std::string& word);

struct DynamicsSettings {
  DynamicsMode mode = DynamicsMode::kAuto;

  // With auto, flow is held against the poses in all frames of a young map of one camera, and then
  // in watch_frames on end of each watch_every. What moves is left out from then on
  //   - when, of the tracks that tell, more than a share moved over watch_mean frames (their mean).
  //     With one camera: watch_moved, while the map is young. Where nothing moves it is 0.02 to
  //     0.42 (a drone, 1.5 s after its start), among people who fill the picture 0.8 to 0.96. With
  //     a stereo pair watch_moved at any time. With RGB-D, whose pose leans on all there is and
  //     whose depth tells more of what moves, watch_moved_depth at any time: 0.02 to 0.13, and
  //     0.83;
  //   - when another motion than that of the poses has more of the picture than votes.rival_share
  //     (ShareOfRivalMotion) in watch_rival_frames frames more than not; in votes.rival_frames in a
  //     young map of one camera, which is begun again. Where nothing moves: 5 at most, in a fast
  //     turn (fr1_rpy), elsewhere 0 to 2; among people 17 and more.
  int watch_frames = 16;  // of which votes.agreement_ago pass before flow tells of other motions
  int watch_every = 64;   // frames: 2 s at 30 Hz, and a quarter of what geometry costs
  int watch_mean = 10;
  double watch_moved = 0.5, watch_moved_depth = 0.3;
  int watch_rival_frames = 8;
  // Not while the focal length is only assumed (start.lens_uncertainty is above this) or looked for
  // (refine): with 100 degrees instead of 62 the half of what stands still moves.
  double watch_lens = 0.1;

  // Names as the detector has them, with commas between.
  std::string moving_classes =
      "person,cat,dog,horse,sheep,cow,elephant,bear,zebra,giraffe,bird,bicycle,motorcycle,car,bus,"
      "truck,train,boat,airplane";
  std::string carried_classes =  // things that move when someone moves them
      "chair,backpack,umbrella,handbag,suitcase,sports ball,skateboard,bottle,cup,bowl,laptop,"
      "book,cell phone,teddy bear";

  DetectorSettings detector;

  // Inline schedule: every so many frames one is given to the detector, whose answer is there so
  // many frames later, as a network that takes 0.2 s would have it.
  int detector_every_frames = 6;
  int detector_latency_frames = 6;
  // Threaded: the detector rests after each frame this share of the time that it took, so that
  // tracking and mapping have the processor.
  double detector_rest = 0.5;
  double drop_detections = 0;   // share of its answers that are thrown away, for studies
  double bridge_seconds = 1.0;  // a thing that is no longer detected is kept for as long

  // What each part is worth can be tried by leaving it out.
  bool foreground = true;  // of a box only the mover's own pixels; false: all of it
  bool geometry = true;    // flow, epipolar lines and depth against the predicted pose
  bool propagate = true;   // detections are carried to the present frame; false: used as they come
  bool weigh = true;       // belief weighs residuals; false: a feature counts fully or not at all

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

  uint64_t seed = 1;  // of random samples; the system's

  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
