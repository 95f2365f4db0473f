// Chooses the camera of a run: given, estimated before the run, or estimated during it.
#pragma once

#include <functional>
#include <string>

#include "alidade/run/calibration/camera_finding.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/setup/run_setup.h"
#include "alidade/system/slam.h"

namespace alidade {

// The camera of the run: the source's, or a better one where that is a guess: a loaded map's
// (`saved`, may be null), else that of FindCamera() for recordings of one camera. Live cameras, and
// recordings without passes beforehand, are calibrated during the run; `setup.settings` are changed
// accordingly. Warns of a camera that stays unknown. `go_on`: see FindCamera().
CameraFinding LearnCamera(const RunOptions& options, const SourceOptions& wanted,
                          const Camera* saved,
                          const std::function<bool(const CalibrateProgress&)>& go_on,
                          RunSetup& setup);

// At the end: the camera after `frames` frames of online self-calibration (SlamSettings::refine).
// Warns of one that stays unknown.
void TakeRefinedCamera(const Slam& slam, const RunSetup& setup, int frames, CameraFinding& finding);

// camera.yaml for the next recording with the same camera; empty where nothing was found.
// `source`: as typed.
std::string FoundCameraFile(const CameraFinding& finding, const std::string& source);

}  // namespace alidade
