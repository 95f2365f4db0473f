// Applies improved camera parameters to the keyframes of a map.
#pragma once

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"

namespace alidade {

// Recomputes the rolling-shutter correction of all keyframes from their raw keypoint positions
// (features/rolling_shutter.h), with each keypoint's landmark depth. Poses and landmarks are
// unchanged; run an adjustment afterwards.
void CommitShutter(MapCommit& commit, const Camera& camera);

// Undistorts all keypoints again with `camera` (focal length, distortion and rolling shutter).
// Monocular maps only, see UndistortKeypoints().
void CommitCamera(MapCommit& commit, const Camera& camera);

// Camera motion during the keyframe's readout (Frame::motion) in current map units per second; zero
// if unknown.
Vector6d MotionOf(const KeyFrame& keyframe);

}  // namespace alidade
