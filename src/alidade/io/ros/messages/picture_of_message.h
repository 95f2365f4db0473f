// Decodes the images in messages.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// `use` as in image_codec.h. Depth is CV_16UC1 in millimeters or CV_32FC1 in meters. Throws Error
// (input) when the message is damaged or has an unknown encoding. Images and colors of 16 bits a
// channel stay so (CV_16UC1, CV_16UC3): see GrayLevels.
DecodedImage PictureOf(const RosPicture& picture, ImageUse use);

// Throws Error (input) naming the encodings that are read when the message has another one.
void CheckEncoding(const RosPicture& picture);

// Width and height from the message or from its JPEG or PNG header, without decoding.
cv::Size SizeOfPicture(const RosPicture& picture);

// true for a depth image, by its encoding or as image_transport's compressedDepth.
bool IsDepth(const RosPicture& picture);

}  // namespace alidade
