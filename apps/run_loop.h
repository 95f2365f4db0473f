// Feeds a source to a Slam, frame by frame.
#pragma once

#include "alidade/io/read_ahead.h"
#include "mask_writer.h"
#include "run_options.h"
#include "run_record.h"
#include "terminal.h"

namespace alidade {

// From now on Ctrl-C (or a TERM signal) lets RunFrames() return; a second one ends the program.
void CatchInterrupts();
bool Interrupted();
inline constexpr int kInterruptedStatus = 130;  // exit status of a run that was

// Plays `source` into `slam` to the end, or until interrupted, and waits for the workers. Frames
// that cannot be used are warned about, counted and left out. `masks` may be null.
void RunFrames(ReadAhead& source, const Rate& rate, Slam& slam, Terminal& terminal,
               RunRecord& record, MaskWriter* masks);

}  // namespace alidade
