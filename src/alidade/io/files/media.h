// Images that are neither JPEG nor PNG, videos and live cameras, by OpenCV's imgcodecs and videoio.
// Linking those costs 77 MB and 0.1 s at every start, so they live in a shared module of their own,
// loaded when first needed.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/media/media_module.h"

namespace alidade {

// A problem, too, when there is no module to ask.
// What an image's EXIF data say of the lens: focal length in 35 mm equivalents, mm; 0: nothing, or
// no module.
double FocalLength35OfImage(std::string_view bytes);

DecodedImage DecodeByMediaModule(std::string_view bytes, ImageUse use);

// Throw Error when it cannot be opened, or the module is missing.
std::unique_ptr<MediaStream> OpenVideo(const std::string& path);
std::unique_ptr<MediaStream> OpenLiveCamera(int number);

}  // namespace alidade
