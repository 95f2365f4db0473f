// Local mapping of keyframes: triangulates, fuses, adjusts and culls landmarks (Mur-Artal et al.
// 2015, §VI).
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
  MapId split;  // new map that the keyframe and some before it were split into; invalid: no split
  BundleReport bundle;
};

// Insert() and InsertTwoViews() may run on the tracking thread while another thread runs Process()
// and KeepWithinLimit().
class Mapper {
 public:
  // `camera`: of the frames; depth_factor and baseline are 0 for monocular use.
  Mapper(MapStore& map, const Camera& camera, MapperSettings settings);

  // Adds a keyframe and the landmarks from its depth immediately; fast enough for the tracking
  // thread. `matches`: one per keypoint. `anchor`: pose relative to the parent keyframe, which may
  // have been corrected since; without a keyframe it starts a new map. Returns the new id.
  KeyFrameId Insert(std::shared_ptr<const Frame> frame, const Anchor& anchor,
                    std::span<const LandmarkId> matches);
  // True if a keypoint's depth is accurate enough for Insert() to create a landmark.
  bool MakesLandmark(const Keypoint& keypoint) const;
  // Initial monocular map: two keyframes and the points between them.
  struct TwoViewMap {
    std::shared_ptr<const Frame> a, b;
    Se3 T_b_a;  // |t| = 1
    struct Point {
      Eigen::Vector3d p_a;  // in the frame of a
      int keypoint_a, keypoint_b;
    };
    std::vector<Point> points;
  };
  // Creates a map, adjusts it and scales it to a median depth of 1 in a. Returns b's id.
  KeyFrameId InsertTwoViews(const TwoViewMap& start);

  // Adds the tracker's sightings since the last call: expected landmarks, and whether found.
  // Thread-safe.
  void Count(std::span<const std::pair<LandmarkId, bool>> sightings);

  // Restores the static probabilities of a loaded map's landmarks. Call before the first frame.
  void Restore(const MapSnapshot& map);
  // Adds evidence from frames for landmarks being static, as log-odds. Thread-safe. The next
  // Process() applies it to the map and removes landmarks that are likely to move.
  void Doubt(std::span<const std::pair<LandmarkId, float>> evidence);

  // Performs the remaining mapping steps of a keyframe, committing after each. `stop` (may be null)
  // ends the adjustment early.
  MapperReport Process(KeyFrameId id, const std::atomic<bool>* stop = nullptr);

  // Changes MapperSettings::young_static for landmarks created from now on. Thread-safe.
  void SetYoungStatic(float probability) { young_static_ = probability; }

  // Changes the camera model of the map. No other thread may be using the map.
  void SetCamera(const Camera& camera) { camera_ = camera; }

  // Removes the least useful keyframes if there are more than settings.max_keyframes; returns their
  // number. `newest`: the keyframe processed last.
  int KeepWithinLimit(KeyFrameId newest);

 private:
  std::vector<uint8_t> Appeared(const MapState& map, KeyFrameId keyframe) const;
  void TellOfPassing(std::span<const uint8_t> appeared);  // the user, once
  void Remove(std::span<const KeyFrameId> keyframes);     // with landmarks that only they observe
  // Returns the new map if keyframes were split off: MapperSettings::min_known_scale.
  MapId SplitWhereScaleIsUnknown(KeyFrameId id);
  std::vector<std::pair<LandmarkId, float>> TakeBelief();
  void ForgetTalliesOfTheGone(const MapSnapshot& map);

  MapStore& map_;
  Camera camera_;
  MapperSettings settings_;
  bool has_depth_;
  bool passing_told_ = false;  // TellOfPassing() has told
  std::atomic<float> young_static_;
  std::vector<LandmarkId> young_;  // on probation
  std::mutex tallies_mutex_;
  IdMap<LandmarkId, SightingTally> tallies_;
  std::vector<LandmarkId> doubted_;  // evidence added since the last Process()
};

}  // namespace alidade
