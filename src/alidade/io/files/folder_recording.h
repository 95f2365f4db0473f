// A plain folder of images: frame i was taken at i / fps.
#pragma once

#include <string>

#include "alidade/io/files/recording.h"

namespace alidade {

bool IsImageFolder(const std::string& folder);

// `fps`: of the camera file given by the user; without one that of camera.yaml in the folder,
// else 30.
Recording ReadFolderRecording(const std::string& folder, std::optional<double> fps);

}  // namespace alidade
