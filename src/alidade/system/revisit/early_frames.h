// Deferred localization with one camera. Buffers frames without a pose (before the start of a map,
// or lost) and the frames tracked in the first settings.settle_frames frames of a map, whose poses
// rest on two views. Localizes them again settings.settle_frames frames after the start of the map
// (docs/development/decisions/0016-deferred-localization.md). Holds at most settings.max_frames
// frames; used by the driving thread.
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

  // Buffers a frame without a pose while a map may start. `index`: of the frame in the log.
  void Wait(const Frame& frame, int index);
  // `map` was started with frame `number`: the waiting frames are to be localized in it.
  void Begin(MapId map, int number);
  // Buffers a frame that was tracked in the newest map, if that is young.
  void Tracked(const Frame& frame, int index);
  // Whether Tracked() would buffer frame `number`.
  bool Wants(int number) const { return map_.valid() && number - begun_ < settings_.settle_frames; }
  // The newest map is dropped: its frames may be localized in the next one.
  void Release();
  // Drops the waiting frames: the frames to come need not continue them.
  void ForgetWaiting();

  // From then on nothing here needs a keyframe that was culled in `map`.
  void Reanchor(const MapSnapshot& map);

  // Undistorts the keypoints of all buffered frames for another camera.
  void SetCamera(const Camera& camera);

  // Localizes up to `count` buffered frames, newest first, unless frame `number` is less than
  // settings.settle_frames frames after the start of the newest map. Of the frames before a start,
  // the rest is given up after settings.max_missed_frames consecutive failures, or at a position
  // beyond the motion gate (settings.max_leap).
  void Place(int count, int number, Tracker& tracker, const MapSnapshot& map, FrameLog& log);

 private:
  struct Early {
    std::shared_ptr<const Frame> frame;
    int index = 0;        // in the log
    MapId map;            // where to localize it; invalid: it waits for a map
    bool before = false;  // it came before the start of that map
  };
  void PlaceOne(const Early& early, Tracker& tracker, const MapSnapshot& map, FrameLog& log);
  void Keep(const Frame& frame, int index, MapId map);
  bool Leaps(const TrackEstimate& estimate, const MapSnapshot& map) const;
  void Passed(double time, const Anchor& anchor, MapId map);

  struct Step {  // a localized frame
    double time = 0;
    Anchor anchor;
  };

  EarlyFrameSettings settings_;
  std::deque<Early> frames_;  // oldest first
  MapId map_;                 // the newest map
  int begun_ = 0;             // number of the frame that started it
  int missed_ = 0;   // consecutive frames before the start of missed_in_ that were not localized
  MapId missed_in_;  // see missed_
  // The frames localized last in way_in_, going back in time: the earliest one last.
  std::deque<Step> way_;
  MapId way_in_;  // see way_
};

}  // namespace alidade
