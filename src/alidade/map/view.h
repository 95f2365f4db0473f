// Predicted observation of a landmark in a camera with a given pose.
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
  double distance = 0;    // from the camera center, meters
  // Of the angle between the line of sight and the landmark's mean viewing direction.
  double cosine = 1;
  int level = 0;  // expected pyramid level
};

// nullopt if the landmark is behind the camera, more than `margin` pixels outside the image,
// outside the range of distances in which its scale is in the pyramid, or viewed more than 60° off
// its mean direction (Mur-Artal, Montiel & Tardós 2015, §V-D).
std::optional<LandmarkView> ViewLandmark(const Landmark& landmark, const Camera& camera,
                                         const Se3& T_camera_world, double margin = 0);

// The map with the most keyframes, the first of equals; invalid if there is none.
MapId LargestMap(const MapSnapshot& map);

// Median depth of the keyframe's landmarks along its optical axis; nullopt if it has none.
std::optional<double> MedianDepth(const MapSnapshot& map, const KeyFrame& keyframe);

// Number of the keyframe's landmarks with known scale (Landmark::scale_known).
int CountOfKnownScale(const MapSnapshot& map, const KeyFrame& keyframe);

// True if an inertial sensor measures the keyframe's motion in meters: the adjustment then holds
// the scale where landmarks do not.
bool HasMeasuredMotion(const MapSnapshot& map, const KeyFrame& keyframe);

}  // namespace alidade
