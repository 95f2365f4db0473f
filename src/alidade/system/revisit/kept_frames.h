// Frames since before the start of the newest map, kept to rebuild that map when its camera turns
// out to be another, or when a part of the image turns out to be fixed to the camera. A bounded
// number, features only; used by the driving thread.
#pragma once

#include <deque>
#include <memory>

#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

class KeptFrames {
 public:
  // `capacity`: frames; 0: none is kept.
  explicit KeptFrames(int capacity) : capacity_(capacity) {}

  struct Kept {
    std::shared_ptr<const Frame> frame;
    int index = 0;  // in the trajectory
  };

  // While `seeking` a start, the oldest frames give way to newer ones. Once a map exists, the first
  // frame beyond the capacity ends the keeping for good: the map can no longer be rebuilt.
  void Add(const Frame& frame, int index, bool seeking);
  // `map` was started with `camera` from frames kept here.
  void MapStarted(const Camera& camera, MapId map);
  // That map was dropped. Its frames may serve the next one.
  void MapDropped() { complete_ = false; }
  // The frames so far are useless: the newest map, if there is one, cannot be rebuilt any more.
  void Clear();

  bool keeps() const { return keeps_ && capacity_ > 0; }
  // The frames hold everything the newest map was made of.
  bool CanRebuild() const { return keeps() && complete_ && !frames_.empty(); }
  const std::deque<Kept>& frames() const { return frames_; }  // oldest first, consecutive
  const Camera& started_with() const { return started_with_; }
  MapId map() const { return map_; }  // the one that was started last

 private:
  int capacity_;
  std::deque<Kept> frames_;
  bool keeps_ = true;
  bool complete_ = false;
  Camera started_with_;
  MapId map_;
};

}  // namespace alidade
