// Sources made of other sources: a part of one, or one played forth and back. (read_ahead.h has a
// third.)
#pragma once

#include <memory>

#include "alidade/io/frame_source.h"

namespace alidade {

// Frames `first` to `last` (-1: the end), both included. Throws Error: kUsage for numbers that
// cannot be, kInput when `first` lies past the end.
std::unique_ptr<FrameSource> Clip(std::unique_ptr<FrameSource> source, int first, int last);

// Plays a recording to its end and back to its start, `times` times; 0: `source` as it is. Frames
// at the turning points come once. Frame numbers and times go on growing: played backwards, frames
// lie as far apart as they did forwards; beyond the first pass the stamps are written anew. Throws
// Error (usage) when `source` cannot seek.
std::unique_ptr<FrameSource> Repeat(std::unique_ptr<FrameSource> source, int times);

}  // namespace alidade
