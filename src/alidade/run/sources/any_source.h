// Opens a recording, video, camera or rendered scene.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

// OpenSource(), and also `synth:SCENE?…`: the only place that combines rendering and reading files.
std::unique_ptr<FrameSource> OpenAnySource(const std::string& source,
                                           const SourceOptions& options = {});

// true for a camera, a stream and topics as they are published: their images are not kept.
bool IsLiveSource(const std::string& source);

// The source without the name and password of a stream's address, for messages and results.
std::string SourceToShow(const std::string& source);

// The file or folder of a source, without the ?name=value of a ROS recording. Empty: none (rendered
// scenes, live cameras).
std::string PathOfSource(const std::string& source);

}  // namespace alidade
