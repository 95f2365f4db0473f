// A camera that is known better than when the map was begun.
#pragma once

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"

namespace alidade {

// Places the keypoints of all keyframes anew, from where they are in their images: as `camera`'s
// rolling shutter would have seen them read at once (features/rolling_shutter.h), each with the
// depth of its landmark. Poses and landmarks stay as they are, for an adjustment to follow.
void CommitShutter(MapCommit& commit, const Camera& camera);

// Places them anew as `camera` sees them: another focal length, another distortion, and its rolling
// shutter. Of one camera only (UndistortKeypoints()).
void CommitCamera(MapCommit& commit, const Camera& camera);

// How the camera moved when the keyframe was taken (Frame::motion), in lengths of today. Zero: not
// known.
Vector6d MotionOf(const KeyFrame& keyframe);

}  // namespace alidade
