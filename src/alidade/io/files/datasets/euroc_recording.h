// EuRoC recordings (Burri et al. 2016): mav0/cam0 and cam1, each with data.csv, data/ and
// sensor.yaml; mav0/imu0 with data.csv and sensor.yaml. TUM-VI has the same layout.
#pragma once

#include <string>

#include "alidade/io/files/datasets/recording.h"

namespace alidade {

bool IsEurocFolder(const std::string& folder);  // true when `folder` contains mav0/cam0 or is mav0
Recording ReadEurocRecording(const std::string& folder, bool with_imu = true);

}  // namespace alidade
