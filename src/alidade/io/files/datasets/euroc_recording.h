// EuRoC recordings (Burri et al. 2016): mav0/cam0 and cam1, each with data.csv, data/ and
// sensor.yaml.
#pragma once

#include <string>

#include "alidade/io/files/datasets/recording.h"

namespace alidade {

bool IsEurocFolder(const std::string& folder);  // true when `folder` contains mav0/cam0 or is mav0
Recording ReadEurocRecording(const std::string& folder);

}  // namespace alidade
