// Enters a frame's pose everywhere it is remembered: trajectory, tracker, dynamics and, as a
// keyframe, the map. Used by the driving thread.
#pragma once

#include "alidade/system/frame_log.h"
#include "alidade/system/mover_watch.h"
#include "alidade/system/present_frame.h"
#include "alidade/system/workers/workers.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class FramePlacer {
 public:
  FramePlacer(Workers& workers, Tracker& tracker, MoverWatch& movers, FrameLog& log)
      : workers_(workers), tracker_(tracker), movers_(movers), log_(log) {}

  // `reference`: the keyframe the pose is stored relative to. `map`: the map the pose is in.
  void Place(PresentFrame& now, const PlacedFrame& placed, KeyFrameId reference,
             const MapSnapshot& map);
  // Inserts the frame as a keyframe at `anchor`, without features on moving objects, places it and
  // hands it to the workers. `placed` gets the keyframe's pose and matches.
  void InsertKeyFrame(PresentFrame& now, PlacedFrame& placed, const Anchor& anchor,
                      const Camera& camera);

 private:
  Workers& workers_;
  Tracker& tracker_;
  MoverWatch& movers_;
  FrameLog& log_;
};

}  // namespace alidade
