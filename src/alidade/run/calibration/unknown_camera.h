// Chooses the camera of a run: given, estimated before the run, or estimated during it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/run/play/watcher.h"
#include "alidade/run/results/record.h"
#include "alidade/run/setup/options.h"
#include "alidade/system/slam.h"

namespace alidade {

// Fills in record.camera, and replaces record.source.camera if a better one is available: that of
// the loaded map if there is no calibration, else the result of FindCamera() for recordings of one
// camera. For live cameras, and without options.calibrate_first, the camera is estimated during the
// run. `saved`: null if no map is loaded. Warns if the camera remains unknown.
void LearnCamera(const RunOptions& options, const SourceOptions& wanted, const Camera* saved,
                 const std::vector<RunWatcher*>& watchers, RunRecord& record);

// After the run: the camera estimated during it (SlamSettings::refine). Warns if it remains
// unknown.
void TakeRefinedCamera(const Slam& slam, RunRecord& record);

// camera.yaml for further recordings with the same camera; empty if nothing was estimated.
std::string FoundCameraFile(const RunRecord& record);

}  // namespace alidade
