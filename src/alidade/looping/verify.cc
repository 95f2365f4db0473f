#include "alidade/looping/verify.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "alidade/features/matching.h"
#include "alidade/geometry/pnp.h"
#include "alidade/looping/surroundings.h"
#include "alidade/map/view.h"
#include "alidade/optimize/pose_only.h"
#include "alidade/optimize/sim3_refine.h"

namespace alidade {
namespace {

// Unmistakable place: landmarks found, as a multiple of min_found.
constexpr int kPlainFound = 3;
// Unmistakable place: landmarks found, as a share of those expected.
constexpr double kPlainShare = 0.35;
// Drift limit as a share of the path length when the monocular scale has failed.
constexpr double kBrokenDrift = 0.6;
constexpr size_t kPoseKeyFrames = 4;  // additional keyframes around the place used for the pose
constexpr double kTurnFloor = 0.1;    // radians: a loop may always turn a keyframe this far
constexpr int kMinRatios = 10;        // landmarks known in both maps, needed for a scale estimate
// Largest ratio of the upper to the lower quartile of the depth ratios.
constexpr double kMaxSpread = 1.3;

std::vector<int> Known(const KeyFrame& keyframe) {
  std::vector<int> known;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (keyframe.landmarks[i].valid()) known.push_back(static_cast<int>(i));
  }
  return known;
}

Sim3Match MatchOf(const MapSnapshot& map, const KeyFrame& a, int in_a, const KeyFrame& b, int in_b,
                  const LoopSettings& settings) {
  const Keypoint& keypoint_a = a.frame->keypoints[in_a];
  const Keypoint& keypoint_b = b.frame->keypoints[in_b];
  return {a.T_camera_world * map.Find(a.landmarks[in_a])->p_world,
          b.T_camera_world * map.Find(b.landmarks[in_b])->p_world,
          keypoint_a.pixel(),
          keypoint_b.pixel(),
          settings.noise.sigma_px * ScaleOfLevel(keypoint_a.level),
          settings.noise.sigma_px * ScaleOfLevel(keypoint_b.level)};
}

std::vector<int> All(const KeyFrame& keyframe) {
  std::vector<int> all(keyframe.landmarks.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Pose of camera a in the world frame of b's landmarks, and the scale factor for a's surroundings.
struct Alignment {
  Se3 T_camera_world;
  double growth = 1;
};

Alignment AlignmentOf(const Sim3& T_a_b, const KeyFrame& b) {
  const Sim3 T_a_world = T_a_b * Sim3{1, b.T_camera_world.R, b.T_camera_world.t};
  return {{T_a_world.R, T_a_world.t / T_a_world.s}, 1 / T_a_world.s};
}

int DifferentKeypoints(const std::vector<FusedSighting>& found) {
  std::vector<int> keypoints;
  keypoints.reserve(found.size());
  for (const FusedSighting& s : found) keypoints.push_back(s.keypoint);
  std::sort(keypoints.begin(), keypoints.end());
  return static_cast<int>(std::unique(keypoints.begin(), keypoints.end()) - keypoints.begin());
}

class Verifier {
 public:
  Verifier(const MapSnapshot& map, const KeyFrame& keyframe, const KeyFrame& place,
           const Camera& camera, const LoopSettings& settings, KeyFrameId recording)
      : map_(map),
        a_(keyframe),
        b_(place),
        camera_(camera),
        settings_(settings),
        recording_(recording) {
    with_scale_ = camera.StereoBaseline() <= 0;
  }

  std::optional<LoopMatch> Run() {
    const bool both_known = Align();
    if (!both_known && !AlignByPose()) return {};
    around_ = LandmarksAround(map_, b_);
    Search(settings_.search_radius);
    if (both_known) {
      Refine();
    } else if (!RefineByPose()) {
      return {};
    }
    Search(settings_.search_radius / 2);
    const int found = DifferentKeypoints(match_.found);
    const bool merges = a_.map != b_.map;
    if (found < Scaled(merges ? settings_.min_merge_found : settings_.min_found) ||
        found < settings_.min_visible_share * match_.visible)
      return {};
    if (merges ? !CanMerge() : !CanHaveDrifted()) return {};
    if (!Confirmed()) return {};
    match_.keyframe = a_.id;
    match_.place = b_.id;
    match_.T_camera_world = alignment_.T_camera_world;
    match_.growth = alignment_.growth;
    match_.depth = alignment_.growth * MedianDepth(map_, a_).value_or(0);
    return std::move(match_);
  }

 private:
  int Scaled(int count) const {
    return static_cast<int>(std::lround(count * settings_.match_scale));
  }

  bool Align() {
    MatchSettings matching;
    matching.ratio = 0.8;
    const std::vector<int> of_a = Known(a_), of_b = Known(b_);
    for (const IndexMatch& m : MatchSubsets(*a_.frame, of_a, *b_.frame, of_b, matching)) {
      // Both observe one landmark: no new information.
      if (a_.landmarks[m.a] == b_.landmarks[m.b]) continue;
      matches_.push_back(MatchOf(map_, a_, m.a, b_, m.b, settings_));
    }
    if (static_cast<int>(matches_.size()) < Scaled(settings_.min_matches)) return false;
    Sim3RansacSettings ransac;
    ransac.min_inliers = Scaled(settings_.min_aligned);
    ransac.with_scale = with_scale_;
    ransac.seed = settings_.seed + a_.id.value;
    const Sim3RansacResult aligned = SolveSim3Ransac(camera_, matches_, ransac);
    if (!aligned.success) return false;
    T_a_b_ = aligned.T_a_b;
    alignment_ = AlignmentOf(T_a_b_, b_);
    return true;
  }

  // For a recent keyframe with few landmarks: matches all its keypoints with the landmarks of the
  // place and estimates the pose from them.
  bool AlignByPose() {
    MatchSettings matching;
    matching.ratio = 0.8;
    const std::vector<int> all = All(a_);
    std::vector<KeyFrameId> places{b_.id};
    for (size_t i = 0; i < b_.covisible.size() && i < kPoseKeyFrames; ++i)
      places.push_back(b_.covisible[i].id);
    std::vector<std::pair<int, LandmarkId>> best(a_.frame->keypoints.size(), {256, {}});
    for (KeyFrameId id : places) {
      const KeyFrame& place = *map_.Find(id);
      for (const IndexMatch& m :
           MatchSubsets(*a_.frame, all, *place.frame, Known(place), matching)) {
        if (m.distance < best[m.a].first) best[m.a] = {m.distance, place.landmarks[m.b]};
      }
    }
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector2d> pixels;
    std::vector<double> scales;
    for (size_t i = 0; i < best.size(); ++i) {
      if (!best[i].second.valid()) continue;
      points.push_back(map_.Find(best[i].second)->p_world);
      pixels.push_back(a_.frame->keypoints[i].pixel());
      scales.push_back(ScaleOfLevel(a_.frame->keypoints[i].level));
    }
    if (static_cast<int>(points.size()) < Scaled(settings_.min_matches)) return false;
    PnpSettings pnp;
    pnp.min_inliers = Scaled(settings_.min_aligned);
    pnp.seed = settings_.seed + a_.id.value;
    const PnpResult pose = SolvePnpRansac(camera_, points, pixels, scales, pnp);
    alignment_.T_camera_world = pose.T_camera_world;
    return pose.success;
  }

  bool RefineByPose() {
    std::vector<PoseMatch> matches;
    for (const FusedSighting& s : match_.found) {
      const Measurement m = Measure(a_.frame->keypoints[s.keypoint], settings_.noise);
      matches.push_back(
          {map_.Find(s.landmark)->p_world, m.pixel, m.inv_sigma2, m.inv_sigma2_right});
    }
    const PoseOnlyResult pose = OptimizePose(camera_, alignment_.T_camera_world, matches);
    if (pose.inliers < Scaled(settings_.min_aligned)) return false;
    alignment_.T_camera_world = pose.T_camera_world;
    if (!with_scale_) return true;
    // Scale factor: depths of the keyframe's own landmarks in the place's map relative to its own
    // map.
    std::vector<double> ratios;
    for (size_t i = 0; i < matches.size(); ++i) {
      const LandmarkId own = a_.landmarks[match_.found[i].keypoint];
      if (!pose.inlier[i] || !own.valid()) continue;
      const double here = (a_.T_camera_world * map_.Find(own)->p_world).z();
      const double there = (alignment_.T_camera_world * matches[i].p_world).z();
      if (here > 0 && there > 0) ratios.push_back(there / here);
    }
    if (static_cast<int>(ratios.size()) < Scaled(kMinRatios)) return false;
    std::sort(ratios.begin(), ratios.end());
    alignment_.growth = ratios[ratios.size() / 2];
    const double spread = ratios[ratios.size() * 3 / 4] / ratios[ratios.size() / 4];
    return spread < kMaxSpread;
  }

  void Search(double radius) {
    const LandmarkSearch search{radius, settings_.max_distance, {}};
    match_.found = FindLandmarks(map_, around_, a_, alignment_.T_camera_world, camera_, search,
                                 &match_.visible);
  }

  // Of the place's landmarks that project onto some keypoint, the share whose descriptor matches
  // it. A different descriptor at the landmark's position is evidence against the match; a landmark
  // without a keypoint may be occluded and is not counted.
  double AlikeShare() const {
    // Hamming distance 256: any descriptor
    const LandmarkSearch any{settings_.alike_radius, 256, {}};
    const std::vector<FusedSighting> there =
        FindLandmarks(map_, around_, a_, alignment_.T_camera_world, camera_, any);
    const auto alike = std::count_if(there.begin(), there.end(), [&](const FusedSighting& s) {
      return HammingDistance(map_.Find(s.landmark)->descriptor,
                             a_.frame->descriptors[s.keypoint]) <= settings_.max_distance;
    });
    return there.empty() ? 0 : static_cast<double>(alike) / static_cast<double>(there.size());
  }

  // Refines the alignment with the landmarks found that are observed by both keyframes in both
  // maps.
  void Refine() {
    std::vector<Sim3Match> matches;
    for (const FusedSighting& s : match_.found) {
      const Landmark& landmark = *map_.Find(s.landmark);
      const auto in_b = std::find_if(landmark.observations.begin(), landmark.observations.end(),
                                     [&](const Observation& o) { return o.keyframe == b_.id; });
      if (in_b == landmark.observations.end() || !a_.landmarks[s.keypoint].valid()) continue;
      matches.push_back(MatchOf(map_, a_, s.keypoint, b_, in_b->keypoint, settings_));
    }
    if (matches.size() < matches_.size() / 2)
      matches.insert(matches.end(), matches_.begin(), matches_.end());
    const Sim3RefineResult refined = RefineSim3(camera_, T_a_b_, matches, with_scale_);
    if (refined.inliers < Scaled(settings_.min_aligned)) return;
    T_a_b_ = refined.T_a_b;
    alignment_ = AlignmentOf(T_a_b_, b_);
  }

  // Most of the place was found: evidence strong enough to accept even a failed monocular scale.
  bool IsPlain() const {
    const int found = DifferentKeypoints(match_.found);
    return found >= kPlainFound * Scaled(settings_.min_found) &&
           found >= kPlainShare * match_.visible;
  }

  bool CanHaveDrifted() const {
    const double growth = std::max(alignment_.growth, 1 / alignment_.growth);
    const bool broken = growth > settings_.max_scale;
    if (broken && (growth > settings_.max_plain_scale || !IsPlain())) return false;
    const double turned = settings_.turn_drift * TurnBetween(map_, a_.id, b_.id);
    if (RotationAngle(alignment_.T_camera_world, a_.T_camera_world) >
        std::min(settings_.max_turn, kTurnFloor + turned))
      return false;
    const double way = WayBetween(map_, a_.id, b_.id);
    const double shift = (alignment_.T_camera_world.Inverse().t - a_.Centre()).norm();
    return shift < (broken ? kBrokenDrift : settings_.max_drift) * way +
                       settings_.max_drift_floor * MedianDepth(map_, a_).value_or(0);
  }

  // Pose of another keyframe of `a_`'s map in the world frame of the place.
  Se3 InWorldOfPlace(const KeyFrame& other) const {
    Se3 T_other_a = other.T_camera_world * a_.T_camera_world.Inverse();
    T_other_a.t *= alignment_.growth;
    return T_other_a * alignment_.T_camera_world;
  }

  // Monocular: both keyframes need landmarks of known scale to determine the scale between the
  // maps. The closer the implied camera motion between the maps is to the motion gate, the more
  // landmarks must be found and match by descriptors.
  bool CanMerge() const {
    const int least = Scaled(settings_.min_known_scale);
    if (with_scale_ && (CountOfKnownScale(map_, a_) < least || CountOfKnownScale(map_, b_) < least))
      return false;
    const double doubt = Doubt();
    const double alike = std::max(settings_.min_merge_alike, settings_.reach.plain_alike);
    return DifferentKeypoints(match_.found) >=
               doubt * settings_.reach.plain_share * match_.visible &&
           AlikeShare() >= settings_.min_merge_alike + doubt * (alike - settings_.min_merge_alike);
  }

  // DoubtOf() of the camera's motion from the last keyframe of the place's map to the next one of
  // the other map, for two maps of one recording.
  double Doubt() const {
    if (!recording_.valid()) return 0;
    const KeyFrame* next = &a_;
    std::vector<TimedPlace> way;  // newest first
    KeyFrameId last;
    map_.keyframes().ForEachFromLast([&](const KeyFrame& here) {
      if (here.id > a_.id) return true;
      if (here.id < recording_) return false;
      if (here.map == a_.map && !last.valid()) next = &here;
      if (here.map != b_.map) return true;
      if (!last.valid()) last = here.id;
      way.push_back({here.frame->time, here.Centre()});
      return way.front().time - way.back().time < settings_.reach.span;
    });
    if (!last.valid()) return 0;
    std::reverse(way.begin(), way.end());
    const double gone =
        WayBetween(map_, last, b_.id) + alignment_.growth * WayBetween(map_, next->id, a_.id);
    const double depth = alignment_.growth * MedianDepth(map_, a_).value_or(0);
    const TimedPlace there{next->frame->time, InWorldOfPlace(*next).Inverse().t};
    return DoubtOf(way, there, depth, gone, settings_.reach);
  }

  // True if enough covisible keyframes also observe the place, or all of them if there are fewer.
  bool Confirmed() const {
    const LandmarkSearch search{settings_.search_radius, settings_.max_distance, {}};
    int asked = 0, agreed = 0;
    for (KeyFrameId id : TiedTo(a_, a_.map == b_.map ? settings_.tied_share : 0)) {
      if (asked >= settings_.confirm_keyframes) break;
      if (id == b_.id) continue;
      const KeyFrame& other = *map_.Find(id);
      int visible = 0;
      const auto found =
          FindLandmarks(map_, around_, other, InWorldOfPlace(other), camera_, search, &visible);
      const int keypoints = DifferentKeypoints(found);
      ++asked;
      agreed += keypoints >= Scaled(settings_.confirm_found) &&
                keypoints >= settings_.min_visible_share * visible;
    }
    return agreed >= std::min(settings_.confirm_needed, asked);
  }

  const MapSnapshot& map_;
  const KeyFrame& a_;
  const KeyFrame& b_;
  const Camera& camera_;
  const LoopSettings& settings_;
  const KeyFrameId recording_;
  bool with_scale_ = true;
  std::vector<Sim3Match> matches_;  // matched by descriptors alone
  std::vector<LandmarkId> around_;  // landmarks of the place
  Sim3 T_a_b_;
  Alignment alignment_;
  LoopMatch match_;
};

}  // namespace

std::optional<LoopMatch> VerifyLoop(const MapSnapshot& map, KeyFrameId keyframe, KeyFrameId place,
                                    const Camera& camera, const LoopSettings& settings,
                                    KeyFrameId recording) {
  const KeyFrame *a = map.Find(keyframe), *b = map.Find(place);
  if (!a || !b) return {};
  return Verifier(map, *a, *b, camera, settings, recording).Run();
}

}  // namespace alidade
