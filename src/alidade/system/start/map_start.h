// Starts a map: from one frame with depth, or from two views of one camera (ORB-SLAM §IV,
// Mur-Artal, Montiel & Tardós 2015). Used by the driving thread.
#pragma once

#include "alidade/system/frame_placer.h"
#include "alidade/system/mover_watch.h"
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
  MoverWatch& movers;
  FramePlacer& placer;
};

class MapStart {
 public:
  explicit MapStart(const MapStartParts& parts) : parts_(parts) {}

  // Whether a map may start with the present frame, in which no known place was recognized: at once
  // while seeking, after settings.new_map_seconds and new_map_frames informative frames when lost.
  // `steady`: the frame's time on the steady clock, seconds. `first_number`: Frame::number of the
  // first frame, larger than those of a loaded map.
  bool MayStart(const PresentFrame& now, double steady, int first_number);
  // Starts a map with the present frame if that is possible: result.failure says why not. `camera`:
  // the frame's. Features on moving objects do not enter it.
  TrackResult Start(PresentFrame& now, const Camera& camera);

 private:
  void LeaveMap(int first_number);
  TrackResult StartWithDepth(PresentFrame& now, const Camera& camera);
  TrackResult StartWithMotion(PresentFrame& now, const Camera& camera);

  MapStartParts parts_;
};

}  // namespace alidade
