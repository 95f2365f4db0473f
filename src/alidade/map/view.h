// A landmark as a camera at a given pose would see it.
#pragma once

#include <optional>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/landmark.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

struct LandmarkView {
  Eigen::Vector2d pixel;  // undistorted
  double right_x = -1;    // column in the right image; -1 for a monocular camera
  double distance = 0;    // metres, from the camera's centre
  double cosine = 1;      // between the line of sight and the mean viewing direction
  int level = 0;          // pyramid level it should be found on
};

// nullopt: behind the camera, outside the image (by more than `margin` pixels), outside the range
// of distances where its scale is in the pyramid, or seen from more than 60° off its mean direction
// (ORB-SLAM §V-D).
std::optional<LandmarkView> ViewLandmark(const Landmark& landmark, const Camera& camera,
                                         const Se3& T_camera_world, double margin = 0);

// The map with most keyframes, of several as large the first; invalid: there is none.
MapId LargestMap(const MapSnapshot& map);

// Of the landmarks a keyframe shows, along its optical axis; nullopt when it shows none.
std::optional<double> MedianDepth(const MapSnapshot& map, const KeyFrame& keyframe);

// Landmarks of the keyframe whose scale is known (Landmark::scale_known).
int CountOfKnownScale(const MapSnapshot& map, const KeyFrame& keyframe);

}  // namespace alidade
