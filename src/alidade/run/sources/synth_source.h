// Rendered recordings as sources: `synth:SCENE?frames=600&actors=3&seed=7`, nothing on disk.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"
#include "alidade/synth/settings.h"

namespace alidade {

bool IsSynthSource(const std::string& source);  // starts with "synth:"

// The options are named like the flags of `alidade synth`, with _ for the - in a name. Without
// `frames`: once round the scene's path. Switches (exposure …) may stand alone or be set to 0 or 1;
// blur and rolling, too, or to milliseconds. calibrated=0: nothing is told of the camera, and one
// is assumed as of a video. Throws Error (usage).
SynthSettings ParseSynthSource(const std::string& source);

// Frames are rendered when asked for. Same options as for recordings on disk: a sensor the settings
// do not give, e.g. stereo without `stereo`, throws Error (usage); rgbd without `stereo` is the
// default.
std::unique_ptr<FrameSource> OpenSynthSource(const std::string& source,
                                             const SourceOptions& options = {});

// A rendered source that tells where the actors are, too.
class ActorSource : public FrameSource {
 public:
  // Of the frame that Next() gave last: CV_8U, 255 = an actor.
  virtual cv::Mat ActorMask() const = 0;
};
std::unique_ptr<ActorSource> OpenActorSource(const std::string& source,
                                             const SourceOptions& options = {});  // from frame 0 on

// Stamps as the source and the files of `alidade synth` have them: seconds with 6 digits after the
// point.
std::string SynthStamp(double seconds);

}  // namespace alidade
