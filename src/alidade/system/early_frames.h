// Frames that came before the map knew better: those before one camera's start (lost ones included,
// where another map begins), which had no pose, and those placed in the first seconds of its map,
// when two views were all it had. Once the map has settled each is placed in it anew. Holds a
// bounded number of frames; used by the tracker's thread.
#pragma once

#include <deque>
#include <memory>

#include "alidade/map/map_store.h"
#include "alidade/system/frame_log.h"
#include "alidade/system/settings.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class EarlyFrames {
 public:
  explicit EarlyFrames(const EarlyFrameSettings& settings) : settings_(settings) {}

  // `index`: of the frame in the log. A frame without a pose, while a map is or may be begun …
  void Wait(const Frame& frame, int index);
  // … which `map` then is, by frame `number`: the frames that wait are its own from now on.
  void Begin(MapId map, int number);
  // A frame that was tracked in that map.
  void Tracked(const Frame& frame, int index);
  // The newest map is dropped: its frames may be localized in the next one.
  void Release();
  // What waits is of no use any more: the next frame need not go on where it was.
  void ForgetWaiting();

  // From then on nothing here needs a keyframe that was culled in `map`.
  void Reanchor(const MapSnapshot& map);

  // All frames that wait are of this camera.
  void SetCamera(const Camera& camera);

  // Places `count` frames at most whose map has settled by frame `number`. Those before the start
  // come last first, and no further than they are recognised.
  void Place(int count, int number, Tracker& tracker, const MapSnapshot& map, FrameLog& log);

 private:
  struct Early {
    std::shared_ptr<const Frame> frame;
    int index = 0;
    MapId map;            // none: it waits
    bool before = false;  // the start
  };
  void PlaceOne(const Early& early, Tracker& tracker, const MapSnapshot& map, FrameLog& log);
  void Keep(const Frame& frame, int index, MapId map);
  bool Leaps(const TrackEstimate& estimate, const MapSnapshot& map) const;
  void Passed(double time, const Anchor& anchor, MapId map);

  struct Step {  // where the camera was
    double time = 0;
    Anchor anchor;
  };

  EarlyFrameSettings settings_;
  std::deque<Early> frames_;  // oldest first
  MapId map_;                 // begun last
  int begun_ = 0;             // number of the frame it was begun with
  int missed_ = 0;            // frames before the start that were not recognised, on end …
  MapId missed_in_;           // … in that map
  std::deque<Step> way_;      // going back: where those placed last were, the earliest one last …
  MapId way_in_;              // … in that map
};

}  // namespace alidade
