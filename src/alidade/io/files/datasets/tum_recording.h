// TUM RGB-D recordings (Sturm et al. 2012): rgb.txt and depth.txt list images with times. A depth
// image is assigned to the color image nearest in time.
#pragma once

#include <string>

#include "alidade/io/files/datasets/recording.h"

namespace alidade {

bool IsTumFolder(const std::string& folder);
Recording ReadTumRecording(const std::string& folder);

}  // namespace alidade
