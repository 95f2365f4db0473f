// Finds the pose of a frame that does not follow a tracked one: near the extrapolated motion first,
// then in keyframes with similar descriptors (ORB-SLAM §V-C, Mur-Artal, Montiel & Tardós 2015).
// Used by the driving thread.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/system/frame_log.h"
#include "alidade/system/inertial/inertial_watch.h"
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
  // Where the next frame is by dead reckoning; nullopt: it is not known.
  void SetReckoned(std::optional<InertialWatch::Reckoned> reckoned) {
    reckoned_ = std::move(reckoned);
  }
  Found Find(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map, bool lost) const;

 private:
  bool CanBeThere(const TrackEstimate& found, const MapSnapshot& map) const;
  bool AgreesWithReckoned(const PlacedFrame& placed, double drift) const;
  std::vector<KeyFrameId> PlacesLike(const Frame& frame, const MapSnapshot& map, bool lost) const;

  std::optional<InertialWatch::Reckoned> reckoned_;
  const SlamSettings& settings_;
  Workers& workers_;
  Tracker& tracker_;
  const FrameLog& log_;
};

}  // namespace alidade
