// KITTI odometry sequences (Geiger, Lenz & Urtasun 2012): image_0/ and image_1/ (or the color pair
// image_2/ and image_3/), times.txt, and calib.txt with the projections P0..P3 of the rectified
// cameras.
#pragma once

#include <string>

#include "alidade/io/files/datasets/recording.h"

namespace alidade {

bool IsKittiFolder(const std::string& folder);
Recording ReadKittiRecording(const std::string& folder);

}  // namespace alidade
