// Plays a source into a Slam frame by frame.
#pragma once

#include <vector>

#include "alidade/io/read_ahead.h"
#include "alidade/run/play/watcher.h"
#include "alidade/run/results/mask_writer.h"
#include "alidade/run/results/record.h"
#include "alidade/run/setup/options.h"

namespace alidade {

// The input of Slam::Track() for a frame.
inline FrameInput InputOf(const SourceFrame& frame) {
  return {frame.time, frame.image, frame.right, frame.depth, frame.color};
}

// From now on Ctrl-C (or SIGTERM) makes RunFrames() return after the workers have finished. A
// second signal skips that wait, a third one ends the program.
void CatchInterrupts();
bool Interrupted();
// The same for programs with their own signal handlers (Python): the first request ends the run and
// writes its results, the second one does not wait for workers. Reset before the next run.
void RequestInterrupt();
void ForgetInterrupts();
inline constexpr int kInterruptedStatus = 130;  // exit status of an interrupted run

// Plays `source` into `slam` to the end or until interrupted, and waits for the workers. Unusable
// frames are counted, reported and skipped. In the threaded schedule a frame that is late by more
// than settings.time.max_latency is skipped if a newer one is available. `masks` may be null.
void RunFrames(ReadAhead& source, const Rate& rate, Slam& slam,
               const std::vector<RunWatcher*>& watchers, RunRecord& record, MaskWriter* masks);

}  // namespace alidade
