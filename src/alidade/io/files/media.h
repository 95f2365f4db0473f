// Images that are neither JPEG nor PNG, videos and live cameras, by OpenCV's imgcodecs and videoio.
// Linking those costs 77 MB and 0.1 s at every start, so they live in a shared module of their own,
// loaded when first needed.
#pragma once

#include <string_view>

#include "alidade/io/files/image_codec.h"

namespace alidade {

DecodedImage DecodeByMediaModule(std::string_view bytes, ImageUse use);

}  // namespace alidade
