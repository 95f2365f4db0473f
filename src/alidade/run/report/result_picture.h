// The image that shows a result folder at a glance.
#pragma once

#include <string>

namespace alidade {

// A PNG or JPEG file: semidense.png of the folder, or else its landmarks with the camera's path,
// from behind the first camera. Empty: nothing was mapped. Throws Error (input) for a file that
// cannot be read.
std::string PictureOfResult(const std::string& folder);

}  // namespace alidade
