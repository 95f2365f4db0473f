// Sources made of other sources: a part of one, one forth and back, one read ahead of time.
#pragma once

#include <memory>

#include "alidade/io/frame_source.h"

namespace alidade {

// Frames `first` to `last` (-1: the end), both included. Throws Error: kUsage for numbers that
// cannot be, kInput when `first` lies past the end.
std::unique_ptr<FrameSource> Clip(std::unique_ptr<FrameSource> source, int first, int last);

}  // namespace alidade
