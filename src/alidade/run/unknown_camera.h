// What a run does about its camera: takes it as told, or finds it first.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/run/options.h"
#include "alidade/run/record.h"
#include "alidade/run/watcher.h"

namespace alidade {

// For recordings of a camera that is only guessed: no map is begun on what a turn with another lens
// explains, unless the settings say how much to allow for.
void BeWaryOfTurns(SlamSettings& settings);

// Fills in record.camera, and record.source.camera where a better one than the source's is found:
// a loaded map's when nothing is known, else by FindCamera(), for recordings of one camera.
// `saved`: null when no map is loaded. Warns of a camera that stays unknown.
void LearnCamera(const RunOptions& options, const SourceOptions& wanted, const Camera* saved,
                 const std::vector<RunWatcher*>& watchers, RunRecord& record);

// camera.yaml for the next recording with the same camera; empty where nothing was found out.
std::string FoundCameraFile(const RunRecord& record);

}  // namespace alidade
