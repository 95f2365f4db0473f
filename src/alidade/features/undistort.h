// A frame's keypoints under a camera that is known better than when they were found.
#pragma once

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

// Puts each keypoint where `camera` sees it without distortion, from its place in the image as
// taken. What was done to it for a rolling shutter is undone. Frames without depth only:
// disparities stay as they are.
void UndistortKeypoints(const Camera& camera, Frame& frame);

}  // namespace alidade
