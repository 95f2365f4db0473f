// Rendered recordings as sources: `synth:SCENE?frames=600&actors=3&seed=7`, without files.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"
#include "alidade/synth/recording.h"
#include "alidade/synth/settings.h"

namespace alidade {

bool IsSynthSource(const std::string& source);  // starts with "synth:"

// Options have the names of the flags of `alidade synth`, with _ or -. Default of `frames`:
// once along the path of the scene. Switches (exposure …) may have no value, 0 or 1; blur and
// rolling also milliseconds. calibrated=0: no calibration; the camera is assumed as for a video.
// Throws Error (usage).
SynthSettings ParseSynthSource(const std::string& source);

// The recording with these settings; that of a flight reads its files. Throws Error.
SynthRecording MakeSynthRecording(const SynthSettings& settings);

// Frames are rendered on demand. Options as for recordings on disk. Throws Error (usage) for a
// sensor that the scene does not have, for example stereo without `stereo`; the default is rgbd
// without `stereo`.
std::unique_ptr<FrameSource> OpenSynthSource(const std::string& source,
                                             const SourceOptions& options = {});

// A rendered source that also provides masks of the actors.
class ActorSource : public FrameSource {
 public:
  // For the last frame returned by Next(): CV_8U, 255 = an actor.
  virtual cv::Mat ActorMask() const = 0;
};
std::unique_ptr<ActorSource> OpenActorSource(const std::string& source,
                                             // starting at frame 0
                                             const SourceOptions& options = {});

// Time stamps as in the files of `alidade synth`: seconds with 6 decimals.
std::string SynthStamp(double seconds);

}  // namespace alidade
