// Which keypoints of a placed frame are landmarks of the local map (ORB-SLAM §V-D).
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/tracking/local_map.h"
#include "alidade/tracking/placed_frame.h"
#include "alidade/tracking/settings.h"

namespace alidade {

struct LocalMatches {
  std::vector<LandmarkId> matches;  // one for each keypoint: the frame's own, and those found
  std::vector<LandmarkId>
      visible;  // landmarks looked for because they should be in sight, in order
};

// Projects the landmarks the frame does not have yet and matches them near where they should be
// seen. A keypoint goes to the landmark most like it. The same with any number of threads.
LocalMatches MatchLocalMap(const PlacedFrame& placed, const LocalMap& local, const Camera& camera,
                           const TrackerSettings& settings);

}  // namespace alidade
