// Video files, decoded by FFmpeg's libraries.
#pragma once

#include <memory>

#include "alidade/io/media/media_module.h"

namespace alidade {

// Null when `path` holds no video that can be decoded. Frames come in order of presentation, with
// their own presentation times from the stream's start; images are upright (display matrix).
// `live`: see MediaOpenFunction.
std::unique_ptr<MediaStream> OpenVideoFile(const char* path, bool live);

}  // namespace alidade
