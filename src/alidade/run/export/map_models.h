// One map of a file as what other programs read: plain values, no files.
#pragma once

#include "alidade/io/cloud.h"
#include "alidade/io/colmap.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

// Poses of the keyframes, in order of time.
Trajectory TrajectoryOf(const SavedMap& saved, const MapPart& part);

// The map without the landmarks that fewer keyframes see.
MapPart SeenOften(const SavedMap& saved, MapPart part, int min_observations);

// The landmarks.
Cloud CloudOf(const SavedMap& saved, const MapPart& part);

// Keyframes as images, called by their time (ImageName), with all their keypoints as they lie in
// the image; landmarks as grey points whose tracks are their observations.
ColmapModel ColmapModelOf(const SavedMap& saved, const MapPart& part);

// A time in seconds with the fewest digits after the point, six at least and nine at most, that
// bring it back: TUM's 1305031102.175304 stays that.
std::string ShortTime(double seconds);

}  // namespace alidade
