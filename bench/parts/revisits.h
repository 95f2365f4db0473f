// Frames of a recording with known poses, and which of them see the same place again.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"
#include "bench/measure/recording.h"

namespace alidade::bench {

struct PosedFrame {
  std::shared_ptr<const Frame> frame;
  Se3 T_world_camera;
  cv::Mat depth;          // as in the recording; empty without
  bool keyframe = false;  // the first, and each that has lost a tenth of the last one's view
};

// Where the camera truly was at each frame: as rendered, from the recording's truth, or, when it
// has none, as Slam says. Nothing where even that does not know.
std::vector<std::optional<Se3>> PosesOf(const Recording& recording);

// Evenly spread over the recording, 200 at most. Needs depth images or a second camera: throws
// Error (usage) without.
std::vector<PosedFrame> TakeFrames(const Recording& recording);

// What each pair of frames has in view together: of the landmarks of one, the share that the
// other's image holds and nothing hides, or the other way round, whichever is less.
class SharedViews {
 public:
  SharedViews(const std::vector<PosedFrame>& frames, const Camera& camera);
  int size() const { return size_; }
  double At(int a, int b) const { return shared_[a * size_ + b]; }  // 0…1
  // Of the frames before `query` those that are no longer the same visit: from the last one on that
  // shares less than a quarter of the view with it, back to the first. -1: there are none.
  int LastOfEarlierVisits(int query) const;

 private:
  int size_ = 0;
  std::vector<double> shared_;
};

}  // namespace alidade::bench
