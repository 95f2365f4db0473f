// The frames of a result that have a pose in one of its maps.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/export/pinhole_images.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct PosedFrame {
  double time = 0;      // seconds
  Se3 T_camera_world;   // of the map
  KeyFrameId keyframe;  // invalid: a frame of the trajectory
};

class PosedFrames {
 public:
  // `folder`: of the result, whose trajectory of the map is read; empty, or without one: keyframes
  // only. `R_camera_rectified`: SourceInfo's, which turns the map's world into that of
  // trajectories. `T_now_then`: by which the map was moved since its trajectory was written.
  PosedFrames(const SavedMap& saved, const MapPart& part, const std::string& folder,
              const Eigen::Matrix3d& R_camera_rectified, const Sim3& T_now_then);

  bool has_trajectory() const { return !trajectory_.empty(); }
  size_t keyframes() const { return keyframes_; }
  // Poses at a time (within a microsecond), keyframes before the trajectory: more than one if the
  // map is of several recordings.
  std::vector<PosedFrame> At(double time) const;
  // In order: of all poses, or of keyframes alone.
  std::vector<double> Times(bool keyframes_only) const;
  // The motion at a time, from the poses before and after it in the trajectory; at rest if there
  // are none within half a second. For the median depth of the landmarks of the nearest keyframe.
  ReadoutMotion MotionAt(double time) const;
  // Pixels that rolling shutter moves the borders of the image, exceeded by 5 % of the frames; at
  // most 5 % of the image's side.
  Eigen::Vector2d MarginFor(const Camera& camera) const;

 private:
  std::vector<PosedFrame> all_;                            // by time
  std::vector<PosedFrame> trajectory_;                     // by time
  std::vector<std::pair<double, double>> inverse_depths_;  // of keyframes, by time
  size_t keyframes_ = 0;
};

}  // namespace alidade
