// Replaces the camera in the middle of a run, when the map supports another one than was given.
// Used by the driving thread.
#pragma once

#include "alidade/system/left_out.h"
#include "alidade/system/mover_watch.h"
#include "alidade/system/published.h"
#include "alidade/system/revisit/early_frames.h"
#include "alidade/system/revisit/kept_frames.h"
#include "alidade/system/revisit/map_replay.h"
#include "alidade/system/session.h"
#include "alidade/system/settings.h"
#include "alidade/system/start/young_map.h"
#include "alidade/system/types.h"
#include "alidade/system/workers/workers.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

// The parts that depend on the camera.
struct CameraUpdateParts {
  const SlamSettings& settings;
  Camera& camera;            // the one in use
  Published<Camera>& shown;  // the same, for other threads
  Workers& workers;
  Session& session;
  YoungMap& young;
  EarlyFrames& early;
  KeptFrames& kept;
  Tracker& tracker;
  MoverWatch& movers;
  LeftOut& left_out;
  MapReplay& replay;
};

class CameraUpdate {
 public:
  explicit CameraUpdate(const CameraUpdateParts& parts) : parts_(parts) {}

  // Uses `camera` everywhere from now on. The newest map is rebuilt from its frames' features if it
  // was started with a camera too far from this one and all its frames are kept; otherwise all maps
  // are bent to the new camera by adjustment.
  void Apply(const Camera& camera);

 private:
  void ChangeEverywhere(const Camera& camera);
  void Rebuild(const Camera& camera);

  CameraUpdateParts parts_;
};

}  // namespace alidade
