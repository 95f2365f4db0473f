// Starts a map: from one frame with depth, or from two views of one camera (ORB-SLAM §IV,
// Mur-Artal, Montiel & Tardós 2015). Used by the driving thread.
#pragma once

#include "alidade/system/frame_placer.h"
#include "alidade/system/present_frame.h"
#include "alidade/system/revisit/early_frames.h"
#include "alidade/system/revisit/kept_frames.h"
#include "alidade/system/session.h"
#include "alidade/system/settings.h"
#include "alidade/system/start/young_map.h"
#include "alidade/system/workers/workers.h"

namespace alidade {

// The parts that a start uses and changes.
struct MapStartParts {
  const SlamSettings& settings;
  Workers& workers;
  Session& session;
  YoungMap& young;
  EarlyFrames& early;
  KeptFrames& kept;
  Tracker& tracker;
  FramePlacer& placer;
};

class MapStart {
 public:
  explicit MapStart(const MapStartParts& parts) : parts_(parts) {}

  // Starts a map with the present frame if that is possible: result.failure says why not. `camera`:
  // the frame's. The frame's features are those that may enter a map.
  TrackResult Start(PresentFrame& now, const Camera& camera);

 private:
  TrackResult StartWithDepth(PresentFrame& now, const Camera& camera);
  TrackResult StartWithMotion(PresentFrame& now, const Camera& camera);

  MapStartParts parts_;
};

}  // namespace alidade
