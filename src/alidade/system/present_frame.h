// What belongs to the frame that is being processed; handed from step to step of the pipeline.
#pragma once

#include <memory>
#include <optional>

#include "alidade/map/anchor.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

// The previous frame, which lost its pose with a dropped map, placed relative to a keyframe of the
// map its own predecessor is in. It gets this pose if the present frame is found in that map.
struct Reattachment {
  int index = 0;  // in the trajectory
  Anchor anchor;
  MapId map;
};

// The frame was aligned with an earlier one instead of extracting its features.
struct AlignedEstimate {
  TrackEstimate estimate;
  MapSnapshot map;
};

struct PresentFrame {
  std::shared_ptr<Frame> frame;
  int index = 0;             // in the trajectory
  bool replayed = false;     // a kept frame that is processed again
  double features_left = 1;  // share of its features that were not removed after the extraction
  PlacedFrame placed;        // as tracked; `placed.frame` is set without a pose, too
  KeyFrameId keyframe;       // the keyframe it became
  bool map_left = false;     // the map it was expected in was dropped: its scale is unknown
  std::optional<AlignedEstimate> aligned;
  std::optional<Reattachment> reattachment;
};

}  // namespace alidade
