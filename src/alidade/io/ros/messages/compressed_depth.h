// Depth as image_transport's compressedDepth packs it.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// By the format, "16UC1; compressedDepth rvl".
bool IsCompressedDepth(const RosPicture& picture);

// Width and height from the header; 0 x 0 when it cannot be read.
cv::Size SizeOfCompressedDepth(const RosPicture& picture);

// PNG or RVL, told by the content: older publishers name no codec. CV_16UC1, or for "32FC1"
// CV_32FC1 in meters; 0: no depth. Throws Error (input) when the message is damaged or has another
// codec.
DecodedImage DecodeCompressedDepth(const RosPicture& picture);

}  // namespace alidade
