// Undistorts the keypoints of an existing frame again after the camera model was improved.
#pragma once

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

// Recomputes each keypoint's undistorted position from its raw one. Removes a rolling-shutter
// correction. Only for frames without depth, since disparities are not recomputed.
void UndistortKeypoints(const Camera& camera, Frame& frame);

}  // namespace alidade
