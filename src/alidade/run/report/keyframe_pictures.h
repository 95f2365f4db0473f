// Keyframes of a run as small pictures, for its report.
#pragma once

#include <vector>

#include "alidade/run/results/keyframe_album.h"
#include "alidade/run/results/run_results.h"
#include "alidade/view/report.h"

namespace alidade {

// At most eight, evenly: the picture with its features, and what is known of its depth: by
// semi-dense mapping, else the sensor, else the landmarks it shows.
std::vector<ReportKeyframe> DrawKeyframes(const KeyframeAlbum& album, const RunResults& results,
                                          const Slam& slam, double start);

}  // namespace alidade
