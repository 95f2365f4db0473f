// Finds the pose of a frame that does not follow a tracked one: near the extrapolated motion first,
// then in keyframes with similar descriptors (ORB-SLAM §V-C, Mur-Artal, Montiel & Tardós 2015).
// Used by the driving thread.
#pragma once

#include <memory>
#include <vector>

#include "alidade/system/frame_log.h"
#include "alidade/system/settings.h"
#include "alidade/system/workers/workers.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class Relocalizer {
 public:
  Relocalizer(const SlamSettings& settings, Workers& workers, Tracker& tracker, const FrameLog& log)
      : settings_(settings), workers_(workers), tracker_(tracker), log_(log) {}

  struct Found {
    TrackEstimate estimate;  // not `tracked`: no place was found
    bool by_motion = false;  // where the last motion leads
  };
  // `lost`: the last tracked frame's keyframe is tried first.
  Found Find(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map, bool lost) const;

 private:
  bool CanBeThere(const TrackEstimate& found, const MapSnapshot& map) const;
  std::vector<KeyFrameId> PlacesLike(const Frame& frame, const MapSnapshot& map, bool lost) const;

  const SlamSettings& settings_;
  Workers& workers_;
  Tracker& tracker_;
  const FrameLog& log_;
};

}  // namespace alidade
