// Finds the poses of a recording's frames in the map that was made of it.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "alidade/run/export/own_recording.h"
#include "alidade/run/export/posed_frames.h"

namespace alidade {

class FrameMatcher {
 public:
  // See PosedFrames. `saved` must outlive this object.
  FrameMatcher(const SavedMap& saved, const MapPart& part, const std::string& folder,
               const Eigen::Matrix3d& R_camera_rectified, const Sim3& T_now_then)
      : saved_(saved), poses_(saved, part, folder, R_camera_rectified, T_now_then), check_(saved) {}

  const PosedFrames& poses() const { return poses_; }
  // The keyframe that was made of this frame, or its pose in the trajectory; nullopt: it has none,
  // or was not read.
  std::optional<PosedFrame> Match(const SourceFrame& frame);
  // After the last frame. Throws Error (input) if no frame showed what a keyframe has.
  void CheckFound(const std::string& source) const;
  int other() const { return static_cast<int>(others_.size()); }  // keyframes with another image
  int missing() const;                                            // keyframes without a frame

 private:
  const SavedMap& saved_;
  const PosedFrames poses_;
  ImageCheck check_;
  std::set<KeyFrameId> found_, others_;
};

}  // namespace alidade
