// Video that comes as single packets, decoded by FFmpeg's libraries.
#pragma once

#include <memory>

#include "alidade/io/media/media_module.h"

namespace alidade {

// Null when FFmpeg was built without a decoder for `codec`.
std::unique_ptr<PacketDecoder> MakePacketDecoder(PacketCodec codec);

}  // namespace alidade
