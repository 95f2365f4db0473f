// Initial pose of a frame: from the motion model and the last frame's landmarks, or else from
// descriptor matches with the reference keyframe. And how far it moved since the last frame.
#include <cmath>

#include "alidade/base/part_times.h"
#include "alidade/features/guided_search.h"
#include "alidade/features/matching.h"
#include "alidade/geometry/pnp.h"
#include "alidade/tracking/local_search.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

constexpr double kChiSquared2 = 5.991;  // 95 % with 2 degrees of freedom
constexpr double kChiSquared3 = 7.815;

}  // namespace

PlacedFrame Tracker::Predict(std::shared_ptr<const Frame> frame, const MapSnapshot& map) {
  const PartTimer timer(FramePart::kLastFrame);
  const bool late = IsLate(*frame);
  PlacedFrame guess = PredictByMotion(std::move(frame), map);
  return late || (has_depth_ && unproven_ > 0) ? BetterByLooks(std::move(guess), map) : guess;
}

PlacedFrame Tracker::BetterByLooks(PlacedFrame guess, const MapSnapshot& map) {
  PlacedFrame other;
  other.frame = guess.frame;
  MatchKeyFrame(other, map, reference());
  const int enough = Scaled(settings_.min_after_prediction);
  PlacedFrame guess_around = guess, other_around = other;
  if (guess.inliers >= enough) FindAround(guess_around, map, settings_.local_keyframes);
  if (other.inliers >= enough) FindAround(other_around, map, settings_.local_keyframes);
  const bool better =
      other.inliers >= enough && Agreement(other_around, map) > Agreement(guess_around, map);
  // The guess of a late frame is inaccurate: matches in narrow windows around it would be chance.
  if (IsLate(*guess.frame)) return better ? other_around : guess_around;
  return better ? other : guess;
}

// Matches the surrounding landmarks in windows as wide as after relocalization by descriptors.
void Tracker::FindAround(PlacedFrame& placed, const MapSnapshot& map, int keyframes) {
  TrackerSettings wide = settings_;
  wide.local_radius = wide.local_radius_depth = settings_.relocalize_radius;
  const LocalMap local = gatherer_.Gather(map, placed.matches, placed.T_camera_world, keyframes);
  placed.matches = MatchLocalMap(placed, local, camera_, wide).matches;
  Optimise(placed, map);
}

Tracker::MatchError Tracker::ErrorOf(const PlacedFrame& placed, size_t keypoint,
                                     const Landmark& landmark) const {
  const Measurement m = Measure(placed.frame->keypoints[keypoint], settings_.noise);
  const Eigen::Vector3d p = placed.T_camera_world * landmark.p_world;
  MatchError error;
  error.chi2 = (camera_.Project(p) - m.pixel.head<2>()).squaredNorm() * m.inv_sigma2;
  if (has_depth_ && std::isfinite(m.pixel.z())) {
    const double disparity = camera_.bf() / p.z() - (m.pixel.x() - m.pixel.z());
    error.chi2_disparity = disparity * disparity * m.inv_sigma2_right;
  }
  return error;
}

// Sum over matches of 1 (no error) to 0 (at the 95 % gate of chi²), with the nominal noise, even if
// the pose was found with a wider gate.
double Tracker::Agreement(const PlacedFrame& placed, const MapSnapshot& map) const {
  double sum = 0;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const Landmark* landmark = placed.matches[i].valid() ? map.Find(placed.matches[i]) : nullptr;
    if (!landmark) continue;
    const MatchError error = ErrorOf(placed, i, *landmark);
    const bool deep = error.chi2_disparity >= 0;
    const double chi2 = error.chi2 + (deep ? error.chi2_disparity : 0);
    sum += std::max(0.0, 1 - chi2 / (deep ? kChiSquared3 : kChiSquared2));
  }
  return sum;
}

PlacedFrame Tracker::PredictByMotion(std::shared_ptr<const Frame> frame, const MapSnapshot& map) {
  PlacedFrame guess;
  guess.frame = std::move(frame);
  const Se3 T_last_world = PoseOf(map.state(), last_anchor_);
  last_.T_camera_world = T_last_world;
  const Se3 motion = MotionUntil(guess.frame->time, map);

  const float radius = has_depth_ ? settings_.last_frame_radius_depth : settings_.last_frame_radius;
  PlacedFrame best;
  for (float widen : {1.0f, 2.0f, 4.0f}) {
    guess.T_camera_world = motion * T_last_world;  // not moved if no motion is known
    MatchLastFrame(guess, map, widen * radius);
    const double share = Optimise(guess, map);
    // A window that misses the true positions still finds chance matches, but few of them agree on
    // one pose.
    if (guess.inliers >= Scaled(settings_.min_predicted) && share > settings_.min_agreement)
      return guess;
    if (guess.inliers > best.inliers) best = guess;
  }
  MatchKeyFrame(guess, map, reference());
  return guess.inliers > best.inliers ? guess : best.frame ? best : guess;
}

Se3 Tracker::MotionUntil(double time, const MapSnapshot& map) const {
  if (!last_.frame) return {};
  Se3 motion = motion_.After(time - last_.frame->time);
  motion.t *= map.ScaleOf(reference()) / last_anchor_.scale;
  if (reckoned_ && reckoned_time_ == time)
    return *reckoned_ * PoseOf(map.state(), last_anchor_).Inverse();
  if (turn_ && turn_time_ == time) {  // the same way, with another rotation
    motion.t = *turn_ * (motion.R.transpose() * motion.t);
    motion.R = *turn_;
  }
  return motion;
}

std::optional<Se3> Tracker::PredictedPose(double time, const MapSnapshot& map) const {
  if (reckoned_ && reckoned_time_ == time) return reckoned_;
  if (!last_.frame || !motion_.known() || !map.Find(reference())) return std::nullopt;
  if (!(time - last_.frame->time <= settings_.predict_seconds)) return std::nullopt;
  return MotionUntil(time, map) * PoseOf(map.state(), last_anchor_);
}

std::optional<Se3> Tracker::T_last_camera(const PlacedFrame& placed, const MapSnapshot& map) const {
  if (!last_.frame || placed.frame->number <= last_.frame->number) return std::nullopt;
  Se3 T_last_world = PoseOf(map.state(), last_anchor_);
  if (map.version() != last_version_) {
    PlacedFrame last = last_;
    last.T_camera_world = T_last_world;
    last.passing.clear();
    Optimise(last, map);
    if (last.inliers >= Scaled(settings_.min_tracked)) T_last_world = last.T_camera_world;
  }
  return T_last_world * placed.T_camera_world.Inverse();
}

void Tracker::MatchLastFrame(PlacedFrame& guess, const MapSnapshot& map, float radius) const {
  const Frame& now = *guess.frame;
  guess.matches.assign(now.keypoints.size(), {});
  const Se3 T_last_now = last_.T_camera_world * guess.T_camera_world.Inverse();
  // Meters; objects that came closer are found on a coarser level.
  const double forward = T_last_now.t.z();
  const double baseline = camera_.StereoBaseline();

  std::vector<int> matched;
  std::vector<float> turns;
  for (size_t i = 0; i < last_.matches.size(); ++i) {
    const LandmarkId id = map.Current(last_.matches[i]);
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const Eigen::Vector3d p = guess.T_camera_world * landmark->p_world;
    if (p.z() <= 0.01) continue;
    const Eigen::Vector2d pixel = camera_.Project(p);
    if (!(pixel.x() >= 0 && pixel.x() < camera_.width && pixel.y() >= 0 &&
          pixel.y() < camera_.height))
      continue;

    const Keypoint& before = last_.frame->keypoints[i];
    Sought sought;
    sought.descriptor = &last_.frame->descriptors[i];
    sought.x = static_cast<float>(pixel.x());
    sought.y = static_cast<float>(pixel.y());
    sought.radius = radius * static_cast<float>(ScaleOfLevel(before.level));
    sought.min_level = before.level - 1;
    sought.max_level = before.level + 1;
    if (baseline > 0 && forward > baseline) {
      sought.min_level = before.level;
      sought.max_level = kPyramidLevels - 1;
    } else if (baseline > 0 && -forward > baseline) {
      sought.min_level = 0;
      sought.max_level = before.level;
    }
    if (baseline > 0) sought.right_x = static_cast<float>(pixel.x() - camera_.bf() / p.z());
    const Sighting found =
        FindNear(now, sought, [&](int k) { return !guess.matches[k].valid() && now.IsUsable(k); });
    if (found.keypoint < 0 || found.distance > settings_.max_distance) continue;
    guess.matches[found.keypoint] = id;
    matched.push_back(found.keypoint);
    turns.push_back(before.angle - now.keypoints[found.keypoint].angle);
  }
  const std::vector<bool> keep = ConsistentTurns(turns);
  for (size_t i = 0; i < matched.size(); ++i) {
    if (!keep[i]) guess.matches[matched[i]] = {};
  }
}

void Tracker::MatchKeyFrame(PlacedFrame& guess, const MapSnapshot& map, KeyFrameId id) const {
  guess.matches.assign(guess.frame->keypoints.size(), {});
  guess.inliers = 0;
  const KeyFrame* keyframe = map.Find(id);
  if (!keyframe) return;
  std::vector<int> known, all;
  for (size_t i = 0; i < keyframe->landmarks.size(); ++i) {
    if (keyframe->landmarks[i].valid()) known.push_back(static_cast<int>(i));
  }
  for (int i = 0; i < static_cast<int>(guess.frame->keypoints.size()); ++i) {
    if (guess.frame->IsUsable(i)) all.push_back(i);
  }

  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> scales;
  std::vector<std::pair<int, LandmarkId>> matches;
  for (const IndexMatch& match : MatchSubsets(*keyframe->frame, known, *guess.frame, all)) {
    const Landmark* landmark = map.Find(keyframe->landmarks[match.a]);
    if (!landmark) continue;
    const Keypoint& keypoint = guess.frame->keypoints[match.b];
    points.push_back(landmark->p_world);
    pixels.push_back(keypoint.pixel());
    scales.push_back(ScaleOfLevel(keypoint.level));
    matches.push_back({match.b, landmark->id});
  }
  const int enough = Scaled(settings_.min_after_prediction);
  if (static_cast<int>(matches.size()) < enough) return;
  PnpSettings pnp;
  pnp.min_inliers = enough;
  pnp.seed = settings_.seed + static_cast<uint64_t>(guess.frame->number);
  const PnpResult pose = SolvePnpRansac(camera_, points, pixels, scales, pnp);
  if (!pose.success) return;
  guess.T_camera_world = pose.T_camera_world;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (pose.inlier[i]) guess.matches[matches[i].first] = matches[i].second;
  }
  Optimise(guess, map);
}

}  // namespace alidade
