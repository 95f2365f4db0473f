// An interactive point cloud for HTML pages, rotated with mouse, touch or keys.
#pragma once

#include <string>

#include "alidade/view/cloud_picture.h"
#include "alidade/view/report.h"

namespace alidade {

inline constexpr size_t kMostTurnablePoints = 50000;  // 0.6 MB of HTML; fast on any GPU

// Returns HTML: `picture`, replaced by a canvas where scripts and WebGL are available. The points
// are embedded with a resolution of 1/65535 of the extent and evenly subsampled to
// kMostTurnablePoints. Points far outside, or with a standard deviation above 1 % of the extent,
// are omitted. An empty scene gives the picture alone. `unit`: of the
// scene, for the scale bar.
std::string TurnableHtml(const CloudScene& scene, const ReportPicture& picture,
                         const std::string& unit);

// The still image alone, as an HTML element.
std::string PictureHtml(const ReportPicture& picture);

}  // namespace alidade
