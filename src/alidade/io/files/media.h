// Videos, streams and images other than JPEG and PNG, by FFmpeg and OpenCV's imgcodecs. These
// libraries are large and slow to load, so they are linked by a shared module only, which is loaded
// on first use.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/media/media_module.h"

namespace alidade {

// Focal length of the lens from an image's EXIF data, mm in 35 mm equivalents; 0: not stated, or
// the module is missing.
double FocalLength35OfImage(std::string_view bytes);

DecodedImage DecodeByMediaModule(std::string_view bytes, ImageUse use);

// Throw Error (input) when the source cannot be opened or the module is missing.
std::unique_ptr<MediaStream> OpenVideo(const std::string& path);
// `name`: of the address, for messages.
std::unique_ptr<MediaStream> OpenLiveVideo(const std::string& address, const std::string& name);
std::unique_ptr<PacketDecoder> OpenPacketDecoder(PacketCodec codec);

}  // namespace alidade
