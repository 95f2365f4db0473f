// How a map of one camera begins: two views that tell where the points are, then frames that must
// confirm them before the map is believed.
#pragma once

#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/system/settings.h"
#include "alidade/system/workers.h"
#include "alidade/tracking/mono_start.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class YoungMap {
 public:
  YoungMap(const Camera& camera, const SlamSettings& settings, Workers& workers);

  // A map is sought: the next frame. What begins one is in the map when this returns.
  struct Begun {
    PlacedFrame placed;  // the frame, second of the two keyframes
    KeyFrameId id;       // its
    MapSnapshot map;
    bool holds = false;  // enough points for a trial; otherwise it is to be given up
  };
  std::optional<Begun> Begin(const std::shared_ptr<const Frame>& frame);
  TrackFailure failure() const { return start_.failure(); }  // why the last frame began none
  void ForgetViews() { start_.Reset(); }  // the reference views so far are useless

  // The newest map; invalid before the first one and after Drop().
  MapId map() const { return map_; }
  bool confirmed() const { return trial_left_ == 0; }
  // One frame of the trial: whether it confirms the map. After the last its keyframes are handed to
  // the workers.
  bool Confirm(const TrackEstimate& estimate);
  // So young that it had better be begun again than kept, if it is of something that moves.
  // `reference`: the keyframe the tracker leans on.
  bool IsYoung(const Frame& frame, KeyFrameId reference, const MapSnapshot& map) const;
  // Whether frame `number` needs its Glance(): the map is young.
  bool WantsGlance(int number) const { return started_ >= 0 && number - started_ <= kYoung; }
  // A frame that was placed in the young map. True when frames have shown that the camera stands
  // still: it is said to have moved, and yet the picture behind stays where it was.
  bool StandsStill(const PlacedFrame& placed);
  // The recording ends while the map is young: whether most frames so far have shown that, and a
  // third of those that would be asked for.
  bool StoodStill() const {
    return still_ > moved_ && 3 * still_ >= settings_.start.min_still_frames;
  }
  // Of all frames from now on: views kept so far are of no use any more. `focal_sigma`: relative.
  void SetCamera(const Camera& camera, double focal_sigma);
  void Drop();  // removes the newest map, with the poses of the frames placed in it

 private:
  static constexpr int kYoung = 40;       // frames
  static constexpr int kStillFrames = 8;  // frames at most between two whose pictures are compared

  using Pixels = std::map<LandmarkId, Eigen::Vector2d>;
  struct View {
    int number;  // of the frame
    cv::Mat glance;
    Pixels pixels;  // where landmarks of the map are seen
  };
  // The newest view since which the landmarks now at `now` have moved by least_motion_ (median);
  // null where there is none.
  const View* LastBeforeMotion(const Pixels& now, int number) const;

  SlamSettings settings_;
  Workers& workers_;
  MonoStart start_;
  int started_ = -1;      // number of the frame it was begun with
  int trial_left_ = 0;    // frames that have yet to confirm it
  int begun_points_ = 0;  // landmarks it began with
  MapId map_;
  KeyFrameId keyframes_[2];  // it began with
  // The first of its keyframes and the frames since, the newest last; a glance is 170 kB.
  std::vector<View> views_;
  double least_motion_;        // pixels (start.min_still_motion)
  int still_ = 0, moved_ = 0;  // frames since that show an earlier picture again, and that do not
};

}  // namespace alidade
