// Properties of every decoded image.
#pragma once

#include <string_view>

#include "alidade/io/files/image_codec.h"

namespace alidade::fuzz {

using Decode = DecodedImage(std::string_view bytes, ImageUse use);

// Decodes for each use. Throws Error when no use gives an image.
void UseDecoded(std::string_view bytes, Decode* decode, cv::Size claimed);

}  // namespace alidade::fuzz
