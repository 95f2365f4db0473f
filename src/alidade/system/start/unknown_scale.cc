#include "alidade/system/start/unknown_scale.h"

#include <algorithm>
#include <vector>

namespace alidade {

std::optional<Reattachment> ReattachFrames(MapId gone, const MapStore& maps, FrameLog& log) {
  constexpr int kHistory = 3600;  // frames searched, the newest ones
  std::optional<Reattachment> newest;
  const MapSnapshot map = maps.Snapshot();
  const std::vector<FramePose> frames = log.Trajectory(maps, std::max(0, log.size() - kHistory));
  for (size_t i = 1; i < frames.size(); ++i) {
    const FramePose &before = frames[i - 1], &frame = frames[i];
    if (frame.map != gone || !before.tracked || before.map == gone) continue;
    const Anchor anchor = AnchorTo(map.state(), before.reference, frame.T_world_camera.Inverse());
    if (i + 1 == frames.size()) {
      newest = Reattachment{frame.index, anchor, before.map};
    } else if (frames[i + 1].map == before.map) {
      log.PlaceLate(frame.index, anchor);
    }
  }
  return newest;
}

}  // namespace alidade
