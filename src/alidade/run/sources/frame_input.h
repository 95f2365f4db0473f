// What Slam::Track() takes of a recording's frame, without inertial readings.
#pragma once

#include "alidade/io/frame_source.h"
#include "alidade/system/types.h"

namespace alidade {

inline FrameInput InputOf(const SourceFrame& frame) {
  return {frame.time, frame.image, frame.right, frame.depth, frame.color};
}

}  // namespace alidade
