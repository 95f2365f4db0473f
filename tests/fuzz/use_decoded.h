// What holds of a decoded picture, whatever its file.
#pragma once

#include <string_view>

#include "alidade/io/files/image_codec.h"

namespace alidade::fuzz {

using Decode = DecodedImage(std::string_view bytes, ImageUse use);

// Decodes for each use. Throws Error when there is no picture for any of them.
void UseDecoded(std::string_view bytes, Decode* decode, cv::Size claimed);

}  // namespace alidade::fuzz
