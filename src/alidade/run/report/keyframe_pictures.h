// Small images of keyframes for the report of a run.
#pragma once

#include <vector>

#include "alidade/run/results/keyframe_album.h"
#include "alidade/run/results/run_results.h"
#include "alidade/view/report.h"

namespace alidade {

// At most eight keyframes, evenly distributed: the image with its features, and its depth from
// semi-dense mapping, else from the sensor, else from the landmarks.
std::vector<ReportKeyframe> DrawKeyframes(const KeyframeAlbum& album, const RunResults& results,
                                          const Slam& slam, double start);

}  // namespace alidade
