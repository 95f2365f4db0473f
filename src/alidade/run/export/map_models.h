// Converts one map of a file to the data of other programs; no file access.
#pragma once

#include <functional>
#include <optional>

#include "alidade/io/cloud.h"
#include "alidade/io/colmap.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

// Poses of the keyframes, in order of time.
Trajectory TrajectoryOf(const SavedMap& saved, const MapPart& part);

// The map without landmarks that fewer keyframes observe.
MapPart SeenOften(const SavedMap& saved, MapPart part, int min_observations);

// The landmarks.
Cloud CloudOf(const SavedMap& saved, const MapPart& part);

// A landmark as a gray point. `place`: where an observation is in `model`, whose images are
// complete; nullopt: it is not exported. The track are the others, the error is their mean in front
// of the camera.
ColmapModel::Point PointOf(
    const ColmapModel& model, const Landmark& landmark,
    const std::function<std::optional<ColmapModel::Seen>(const Observation&)>& place);
// Appends it, and enters its number at the keypoints of its track.
void AddPoint(ColmapModel& model, ColmapModel::Point point);

// Keyframes as images, named by their time (ImageName), with all their keypoints in raw image
// coordinates; landmarks as gray points whose tracks are their observations.
ColmapModel ColmapModelOf(const SavedMap& saved, const MapPart& part);

// A time in seconds with the fewest decimals, from six to nine, that represent it exactly: the TUM
// stamp 1305031102.175304 remains the same.
std::string ShortTime(double seconds);

}  // namespace alidade
