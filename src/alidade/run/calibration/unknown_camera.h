// What a run does about its camera: takes it as told, or finds it first.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/run/play/watcher.h"
#include "alidade/run/results/record.h"
#include "alidade/run/setup/options.h"
#include "alidade/system/slam.h"

namespace alidade {

// Fills in record.camera, and record.source.camera where a better one than the source's is found:
// a loaded map's when nothing is known, else by FindCamera(), for recordings of one camera; of
// live ones, and where nothing is to be played beforehand, it is found on the way.
// `saved`: null when no map is loaded. Warns of a camera that stays unknown.
void LearnCamera(const RunOptions& options, const SourceOptions& wanted, const Camera* saved,
                 const std::vector<RunWatcher*>& watchers, RunRecord& record);

// The run is over: what its map told of a camera that was refined on the way
// (SlamSettings::refine). Warns of one that stays unknown.
void TakeRefinedCamera(const Slam& slam, RunRecord& record);

// camera.yaml for the next recording with the same camera; empty where nothing was found out.
std::string FoundCameraFile(const RunRecord& record);

}  // namespace alidade
