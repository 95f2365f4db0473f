// Matching of a frame with a known pose against the local map (Mur-Artal et al. 2015, §V-D).
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/tracking/local_map.h"
#include "alidade/tracking/placed_frame.h"
#include "alidade/tracking/settings.h"

namespace alidade {

// A landmark expected in the image, at the pose of the search.
struct ExpectedLandmark {
  LandmarkId landmark;
  float u = 0, v = 0;  // undistorted pixels
  int level = 0;       // of the pyramid
};

struct LocalMatches {
  std::vector<LandmarkId> matches;  // one per keypoint: existing and new matches
  // Landmarks expected to be visible and therefore searched, in order.
  std::vector<ExpectedLandmark> visible;
};

// Projects the landmarks that are not matched yet and searches them near their predicted positions.
// A keypoint is assigned to the landmark with the most similar descriptor. The result does not
// depend on the number of threads.
LocalMatches MatchLocalMap(const PlacedFrame& placed, const LocalMap& local, const Camera& camera,
                           const TrackerSettings& settings);

}  // namespace alidade
