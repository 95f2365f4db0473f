// A folder of images without times: image i was taken at i / fps seconds.
#pragma once

#include <string>

#include "alidade/io/files/datasets/recording.h"

namespace alidade {

bool IsImageFolder(const std::string& folder);

// `fps`: frame rate of the user's camera file. Without it, that of camera.yaml in the folder is
// used, else 30.
Recording ReadFolderRecording(const std::string& folder, std::optional<double> fps);

}  // namespace alidade
