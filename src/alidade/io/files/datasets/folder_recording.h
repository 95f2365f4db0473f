// A folder of images without times: image i was taken at i / fps seconds.
#pragma once

#include <string>

#include "alidade/io/files/datasets/recording.h"

namespace alidade {

bool IsImageFolder(const std::string& folder);

// The frames have no times yet.
Recording ReadFolderRecording(const std::string& folder);
void SetTimes(Recording& recording, double fps);

}  // namespace alidade
