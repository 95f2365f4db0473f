// Frame sources that wrap another source: a clip of it, or repeated playback. See also
// read_ahead.h.
#pragma once

#include <memory>

#include "alidade/io/frame_source.h"

namespace alidade {

// Frames `first` to `last`, both included; `last` -1: to the end. Throws Error: kUsage for a
// negative or reversed range, kInput when `first` is past the end.
std::unique_ptr<FrameSource> Clip(std::unique_ptr<FrameSource> source, int first, int last);

// Plays a recording forwards and backwards `times` times; 0 returns `source` unchanged. The frame
// at a turning point is returned once. Frame numbers and times keep increasing: backwards, the
// intervals between frames are those of the forward pass. After the first pass the stamps are
// generated from the times. Throws Error (usage) when `source` cannot seek.
std::unique_ptr<FrameSource> Repeat(std::unique_ptr<FrameSource> source, int times);

}  // namespace alidade
