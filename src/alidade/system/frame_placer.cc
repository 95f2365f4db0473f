#include "alidade/system/frame_placer.h"

#include <memory>

#include "alidade/base/part_times.h"
#include "alidade/system/movers.h"

namespace alidade {

void FramePlacer::Place(PresentFrame& now, const PlacedFrame& placed, KeyFrameId reference,
                        const MapSnapshot& map) {
  const Anchor anchor = AnchorTo(map.state(), reference, placed.T_camera_world);
  movers_.Place(WorldOf(reference, map));
  tracker_.Remember(placed, reference, map);
  // The tracker no longer holds landmark ids older than this map.
  workers_.map().ReleaseLandmarkIds(map.version());
  if (now.replayed) {
    log_.PlaceLate(now.index, anchor);
  } else {
    log_.Place(anchor, placed.T_camera_world.Inverse());
  }
}

void FramePlacer::InsertKeyFrame(PresentFrame& now, PlacedFrame& placed, const Anchor& anchor,
                                 const Camera& camera) {
  const PartTimer timer(FramePart::kKeyFrame);
  const std::shared_ptr<const Picture> picture = placed.frame->picture;
  LeaveOutMovers(placed, camera);
  const KeyFrameId id = workers_.mapper().Insert(placed.frame, anchor, placed.matches);
  now.keyframe = id;
  const MapSnapshot map = workers_.map().Snapshot();
  const KeyFrame& keyframe = *map.Find(id);
  placed.T_camera_world = keyframe.T_camera_world;
  placed.matches = keyframe.landmarks;
  tracker_.KeyFrameInserted(placed.frame->number);
  Place(now, placed, id, map);
  workers_.Keep(id, picture.get());
  workers_.Add(id);
}

}  // namespace alidade
