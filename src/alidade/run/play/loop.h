// Plays a source into a Slam frame by frame.
#pragma once

#include <vector>

#include "alidade/io/read_ahead.h"
#include "alidade/run/play/watcher.h"
#include "alidade/run/results/mask_writer.h"
#include "alidade/run/results/run_log.h"
#include "alidade/run/setup/options.h"

namespace alidade {

// From now on Ctrl-C (or a TERM signal) lets RunFrames() return, once the workers are done; a
// second one does not wait for them, a third ends the program.
void CatchInterrupts();
bool Interrupted();
// The same for programs with their own signal handlers (Python): the first request ends the run and
// writes its results, the second one does not wait for workers. Reset before the next run.
void RequestInterrupt();
void ForgetInterrupts();
inline constexpr int kInterruptedStatus = 130;  // exit status of an interrupted run

// Plays `source` into `slam` to the end, or until interrupted, and waits for the workers. Frames
// that cannot be used are warned about, counted and left out. In the threaded schedule a frame that
// is late by more than settings.time.max_latency gives way to a newer one that is there already.
// `settings`: of `slam`. `masks` may be null.
void RunFrames(ReadAhead& source, const Rate& rate, const SlamSettings& settings, Slam& slam,
               const std::vector<RunWatcher*>& watchers, RunLog& log, MaskWriter* masks);

}  // namespace alidade
