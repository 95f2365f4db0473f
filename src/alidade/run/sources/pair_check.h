// Whether the two images of a stereo recording are of one moment, in the right order, and
// rectified.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "alidade/io/frame_source.h"

namespace alidade {

enum class PairFault {
  kNone,
  kSwapped,  // the left image is the right camera's
  kStacked,  // the second camera lies above or below the first one
  kDelayed,  // the right image is of another moment
  kRowsOff,  // corresponding rows differ: another calibration
};

struct PairVerdict {
  PairFault fault = PairFault::kNone;
  int delay = 0;    // kDelayed: frames by which the right images are late
  double rows = 0;  // kRowsOff: median distance of corresponding rows, pixels
  int pairs = 0;    // that were compared
};

// Compares keypoints of up to 16 pairs spread over the recording: matched over the whole image
// without regard to geometry, those of a rectified pair lie in one row, and the left one not to the
// left of the right one. Where they do not, the right images of up to 8 frames before and after are
// compared as well; the delay with most agreeing matches holds if it has a quarter more than none.
// Where everything is far away, disparities of a few pixels say little: delays and stacked cameras
// may pass, and rows that differ look like a stacked camera. `source` is rectified and can seek,
// otherwise nothing is compared; its position is lost.
PairVerdict CheckPairs(FrameSource& source);

// For users: what is wrong, without a full stop; empty for kNone.
std::string PairInWords(const PairVerdict& verdict);

}  // namespace alidade
