// What is left of a frame that ended in the middle, and which parts of the system have stopped.
#include <utility>

#include "alidade/system/slam_impl.h"

namespace alidade {

// A frame ended in the middle. The tracker remembers a frame as a whole or not at all, and goes on
// from the last one; what else is carried from frame to frame is begun anew.
void Slam::Impl::Recover(TrackState before) noexcept {
  state_ = before;
  movers_.Recover();
  young_.Reset();
  EndFrame();
}

void Slam::Impl::EndFrame() noexcept {
  try {
    log_.End();
  } catch (...) {  // no memory: tried again with the next frame, and by Finish()
  }
}

SlamHealth Slam::Impl::Health() const {
  SlamHealth health{workers_.health()};
  for (StageHealth& stage : movers_.health()) health.stages.push_back(std::move(stage));
  return health;
}

}  // namespace alidade
