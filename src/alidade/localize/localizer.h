// The pose of single pictures in a saved map. The picture may come from any camera: a landmark is a
// point in the world, and a picture is brought to the angular resolution of the map's camera, so
// that a landmark has the same size in pixels in both. Neither the sensor that made the map (depth
// camera, stereo pair, one camera) nor its lens needs to be that of the picture.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/io/calibration.h"
#include "alidade/map/map_file.h"

namespace ALIDADE_API alidade {

// Why a picture has no pose.
enum class NoPlace {
  kNone,      // it has one
  kBlank,     // the picture has too little texture
  kUnknown,   // no keyframe shows what the picture shows
  kUnlikely,  // too little of what should be visible is: it may be another place that looks alike
  kSeveral,   // several places agree with the picture equally well
};

struct Placement {
  NoPlace why = NoPlace::kUnknown;  // kNone: the picture has a pose
  // For kUnlikely and kSeveral, what follows is of the best guess.
  // The pose of the camera in the world of `map`. Axes: x right, y down, z ahead. Meters, or map
  // units if `meters` is false.
  Se3 T_world_camera;
  // T_world_camera * Exp(xi) is the true pose with xi = (translation; rotation) ~ N(0, covariance);
  // m², m rad, rad². True relative to the map aligned as a whole (KeyFrameCovariances()): noise of
  // the keypoints, errors that landmarks of one keyframe share, as far as the picture shows them,
  // how well that keyframe is known in the map, what the pose moves without a part of the image
  // (PartErrors()), and how far other poses of the place are. Zero: unknown.
  Matrix6d covariance = Matrix6d::Zero();
  double probability = 0;  // that the pose is right, and not that of a place that looks alike
  MapId map;
  bool meters = false;
  KeyFrameId keyframe;  // that shares the most landmarks with the picture
  int expected = 0;     // landmarks that should be visible from the pose
  int inliers = 0;      // of these, found where they should be
  // Share of the expected landmarks that was found, relative to that of the keyframe itself.
  double agreement = 0;
  int keypoints = 0;  // of the picture
  int tried = 0;      // keyframes that were compared with the picture

  bool placed() const { return why == NoPlace::kNone; }
};

// One word, for programs: blank, unknown, unlikely, several. Empty for kNone.
std::string NameOf(NoPlace why);
// A sentence for users, without a period: what is the matter and what helps. Empty for kNone.
std::string WordsOf(NoPlace why);

// Any number of threads may call Localize() at the same time; they share the map. A picture gets
// the same answer whatever else is asked before or meanwhile.
class Localizer {
 public:
  // Throws Error (input) if the map is empty or its vocabulary is damaged.
  explicit Localizer(SavedMap saved);
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  // `image`: 8 bits, gray or blue green red, as the camera took it, lens distortion included.
  // `camera`: a pinhole or a fisheye, of the image's size; a right camera is not used. Throws Error
  // (input) if they do not fit each other or the calibration cannot be. `min_probability`: of a
  // pose that is believed; 0: that of the map's settings (pose.min_probability).
  Placement Localize(const cv::Mat& image, const Calibration& camera,
                     double min_probability = 0) const;

  const SavedMap& saved() const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace alidade
