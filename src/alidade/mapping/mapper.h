// Turns keyframes into landmarks: triangulates, fuses, adjusts, culls (ORB-SLAM §VI).
#pragma once

#include <atomic>
#include <mutex>
#include <span>
#include <vector>

#include "alidade/map/anchor.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/cull.h"
#include "alidade/mapping/settings.h"

namespace alidade {

struct MapperReport {
  int triangulated = 0, fused = 0, landmarks_culled = 0, keyframes_culled = 0;
  MapId split;  // where the keyframe and some before it became a map of their own
  BundleReport bundle;
};

class Mapper {
 public:
  // `camera`: as the frames are; depth_factor and baseline 0 for monocular use.
  Mapper(MapStore& map, const Camera& camera, MapperSettings settings);

  // Enters a keyframe and the landmarks its depth gives, at once: quick, on the tracker's thread.
  // `matches`: one for each keypoint. `anchor`: where it is, told by its parent, which may have
  // been corrected since; without a keyframe it begins a map.
  KeyFrameId Insert(std::shared_ptr<const Frame> frame, const Anchor& anchor,
                    std::span<const LandmarkId> matches);
  // Whether a keypoint's depth is known well enough for Insert() to make a landmark of it.
  bool MakesLandmark(const Keypoint& keypoint) const;
  // Enters two keyframes and the points between them: a monocular map begins.
  struct TwoViewMap {
    std::shared_ptr<const Frame> a, b;
    Se3 T_b_a;
    struct Point {
      Eigen::Vector3d p_a;
      int keypoint_a, keypoint_b;
    };
    std::vector<Point> points;
  };
  // Adjusted and scaled to a median depth of 1 in a. Returns b's id.
  KeyFrameId InsertTwoViews(const TwoViewMap& start);

  // What the tracker looked for and found since the last call. Thread-safe.
  void Count(std::span<const std::pair<LandmarkId, bool>> sightings);

  // A loaded map: what was believed of its landmarks. Before the first frame.
  void Restore(const MapSnapshot& map);
  // What frames said of landmarks, as log-odds of standing still, to be added up. Thread-safe; the
  // next Process() enters it in the map, and removes those that are likely to move.
  void Doubt(std::span<const std::pair<LandmarkId, float>> evidence);

  // Everything else one keyframe asks for; commits as it goes. `stop` (may be null) cuts the
  // adjustment short.
  MapperReport Process(KeyFrameId id, const std::atomic<bool>* stop = nullptr);

  // MapperSettings::young_static, of landmarks from now on. Thread-safe.
  void SetYoungStatic(float probability) { young_static_ = probability; }

  // The map is of this camera from now on. Nothing else may be at work.
  void SetCamera(const Camera& camera) { camera_ = camera; }

  // When there are more than settings.max_keyframes: removes the least useful, and returns how
  // many. `newest`: the keyframe processed last.
  int KeepWithinLimit(KeyFrameId newest);

 private:
  void Remove(std::span<const KeyFrameId> keyframes);  // what they alone show goes with them
  // The map of their own that keyframes became, if so: MapperSettings::min_known_scale.
  MapId SplitWhereScaleIsUnknown(KeyFrameId id);
  std::vector<std::pair<LandmarkId, float>> TakeBelief();
  void ForgetTalliesOfTheGone(const MapSnapshot& map);

  MapStore& map_;
  Camera camera_;
  MapperSettings settings_;
  bool has_depth_;
  std::atomic<float> young_static_;
  std::vector<LandmarkId> young_;  // on trial
  std::mutex tallies_mutex_;
  IdMap<LandmarkId, SightingTally> tallies_;
  std::vector<LandmarkId> doubted_;  // since the last Process()
};

}  // namespace alidade
