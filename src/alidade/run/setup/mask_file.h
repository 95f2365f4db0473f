// The mask that --mask names.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/geometry/camera.h"

namespace alidade {

// Reads it for Slam::LeaveOut(): CV_8U, 255 = left out, 0 = used (gray values below 128). Throws
// Error (input) if it is no image, if its shape is not that of the camera's images, or if it leaves
// out everything or nothing.
cv::Mat ReadMaskFile(const std::string& path, const Camera& camera);

}  // namespace alidade
