// A recording, video, camera or rendered scene from what the user typed.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

// OpenSource(), and `synth:SCENE?…` besides: rendering and file floors meet in the program only.
std::unique_ptr<FrameSource> OpenAnySource(const std::string& source,
                                           const SourceOptions& options = {});

}  // namespace alidade
