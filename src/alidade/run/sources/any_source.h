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

// The file or folder of a source: without the ?name=value of a ROS recording. Empty: it has none
// (rendered scenes, live cameras).
std::string PathOfSource(const std::string& source);

}  // namespace alidade
