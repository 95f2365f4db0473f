// A cloud in a page that can be turned with a mouse, a finger or the keys.
#pragma once

#include <string>

#include "alidade/view/cloud_picture.h"
#include "alidade/view/report.h"

namespace alidade {

inline constexpr size_t kMostTurnablePoints = 50000;  // 0.6 MB of page, drawn at once by any GPU

// As HTML: `picture`, and where there are scripts and WebGL a canvas in its place. The points are
// in the page, to a 65,535th of the place's extent; of more than kMostTurnablePoints some, evenly.
// Points far off, or known worse than a hundredth of the extent, are left out. An empty scene gives
// the picture alone.
std::string TurnableHtml(const CloudScene& scene, const ReportPicture& picture);

// The picture alone, as an element.
std::string PictureHtml(const ReportPicture& picture);

}  // namespace alidade
