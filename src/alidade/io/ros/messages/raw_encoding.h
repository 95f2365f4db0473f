// The encodings of sensor_msgs/Image.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// Throws Error (input) naming the encodings that are read when `encoding` is not one of them.
void CheckRawEncoding(const std::string& encoding);

// As PictureOf(), for images that are not compressed.
DecodedImage DecodeRawPicture(const RosPicture& picture, ImageUse use);

}  // namespace alidade
