// Pictures out of messages.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// `use`: as of a file (image_codec.h). Depth is CV_16UC1 in millimetres or CV_32FC1 in metres.
// Throws Error (input) when the message is damaged or of an encoding that is not known.
DecodedImage PictureOf(const RosPicture& picture, ImageUse use);

// Width and height without decoding, where the message or its JPEG or PNG header says so.
cv::Size SizeOfPicture(const RosPicture& picture);

// Whether it is depth: by its encoding, or as image_transport's compressedDepth.
bool IsDepth(const RosPicture& picture);

}  // namespace alidade
