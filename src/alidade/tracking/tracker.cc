#include "alidade/tracking/tracker.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/id_map.h"
#include "alidade/base/median.h"
#include "alidade/base/part_times.h"
#include "alidade/features/rolling_shutter.h"
#include "alidade/features/undistort.h"
#include "alidade/tracking/local_search.h"

namespace alidade {
namespace {

// Keyframes whose landmarks are searched before the whole local map.
constexpr int kRelocaliseKeyFrames = 10;

}  // namespace

Tracker::Tracker(const Camera& camera, TrackerSettings settings)
    : camera_(camera),
      settings_(settings),
      has_depth_(camera.StereoBaseline() > 0),
      extractor_(settings.extractor),
      right_extractor_(settings.extractor),
      passing_(camera),
      motion_(settings.motion) {
  settings_.Check();
  settings_.noise.right_from_sensor = camera.baseline <= 0;
}

std::shared_ptr<Frame> Tracker::Extract(const cv::Mat& image, const cv::Mat& right,
                                        const cv::Mat& depth, double time, int number,
                                        const cv::Mat& avoid) {
  auto frame =
      std::make_shared<Frame>(extractor_.ExtractInPlace(image, camera_, time, number, avoid));
  const PartTimer timer(FramePart::kBuffers);
  {
    const PartTimer depth_timer(FramePart::kDepth);
    if (!depth.empty()) AttachDepth(depth, camera_, *frame, settings_.depth_range);
    if (!right.empty())
      MatchStereo(right_extractor_.ExtractInPlace(right, camera_, time, number), camera_, *frame);
  }
  if (settings_.align) {
    extracted_ = frame->image.clone();  // the caller may reuse its buffer
    extracted_number_ = number;
  }
  frame->pyramid.clear();  // needed only for extraction and stereo matching
  frame->image.release();
  return frame;
}

void Tracker::SetCamera(const Camera& camera) {
  camera_ = camera;
  passing_ = PassingPoints(camera);
  reference_ = {};
  if (!last_.frame) return;
  auto last = std::make_shared<Frame>(*last_.frame);
  UndistortKeypoints(camera, *last);
  last_.frame = std::move(last);
}

void Tracker::UndoShutter(Frame& frame, const MapSnapshot& map) const {
  const PartTimer timer(FramePart::kShutter);
  if (!camera_.RollingShutter() || !last_.frame || !motion_.known()) return;
  const double seconds = frame.time - last_.frame->time;
  if (!(seconds > 0)) return;
  const Vector6d motion = MotionUntil(frame.time, map).Log() / seconds;
  PlacedFrame last = last_;
  last.T_camera_world = PoseOf(map.state(), last_anchor_);
  UndoRollingShutter(camera_, motion, {}, InverseDepths(last, map).common, frame);
}

void Tracker::UndoShutter(Frame& frame, TrackEstimate& estimate, const MapSnapshot& map) const {
  UndoShutter(frame, estimate.placed, map);
  if (last_.frame && frame.time > last_.frame->time && camera_.RollingShutter())
    Optimise(estimate.placed, map);
}

// With the motion since the last frame and the depths that the pose of `placed` tells.
void Tracker::UndoShutter(Frame& frame, const PlacedFrame& placed, const MapSnapshot& map) const {
  const PartTimer timer(FramePart::kShutter);
  if (!last_.frame) return;
  const double seconds = frame.time - last_.frame->time;
  if (!(seconds > 0)) return;
  Motion motion = motion_;
  motion.Scale(map.ScaleOf(reference()) / last_anchor_.scale);
  motion.Add(placed.T_camera_world * PoseOf(map.state(), last_anchor_).Inverse(), seconds);
  const InverseDepthsSeen depths = InverseDepths(placed, map);
  UndoRollingShutter(camera_, motion.Velocity(), depths.of_keypoints, depths.common, frame);
}

std::vector<ReadoutMatch> Tracker::ReadoutMatches(const TrackEstimate& estimate,
                                                  const MapSnapshot& map) const {
  const PartTimer timer(FramePart::kShutter);
  const PlacedFrame& placed = estimate.placed;
  std::vector<ReadoutMatch> matches;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const Landmark* landmark = placed.matches[i].valid() ? map.Find(placed.matches[i]) : nullptr;
    if (!landmark) continue;
    const Keypoint& keypoint = placed.frame->keypoints[i];
    const Eigen::Vector3d p = placed.T_camera_world * landmark->p_world;
    if (!(p.z() > 0)) continue;
    Eigen::Vector2d seen = keypoint.pixel();
    if (!estimate.moved.empty()) seen -= estimate.moved[i].cast<double>();
    matches.push_back({p,
                       seen - camera_.Project(p),
                       {keypoint.raw_x, keypoint.raw_y},
                       Measure(keypoint, settings_.noise).inv_sigma2});
  }
  return matches;
}

// Inverse depths of a placed frame's landmarks.
Tracker::InverseDepthsSeen Tracker::InverseDepths(const PlacedFrame& placed,
                                                  const MapSnapshot& map) {
  InverseDepthsSeen seen;
  seen.of_keypoints.assign(placed.matches.size(), 0);
  std::vector<float> all;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const LandmarkId id = map.Current(placed.matches[i]);
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const double z = (placed.T_camera_world * landmark->p_world).z();
    if (!(z > 0)) continue;
    seen.of_keypoints[i] = static_cast<float>(1 / z);
    all.push_back(seen.of_keypoints[i]);
  }
  if (!all.empty()) seen.common = UpperMedian(all);
  return seen;
}

TrackEstimate Tracker::Relocalise(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                                  std::span<const KeyFrameId> candidates,
                                  const std::function<bool(const TrackEstimate&)>& may_be) {
  return FindIn(frame, map, candidates, LogOdds(settings_.evidence.found_again), may_be);
}

TrackEstimate Tracker::FindIn(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                              std::span<const KeyFrameId> candidates, double prior,
                              const std::function<bool(const TrackEstimate&)>& may_be) {
  TrackEstimate lost;
  lost.placed.frame = frame;
  for (KeyFrameId id : candidates) {
    PlacedFrame guess;
    guess.frame = frame;
    MatchKeyFrame(guess, map, id);
    if (guess.inliers < Scaled(settings_.min_after_prediction)) continue;
    FindAround(guess, map, kRelocaliseKeyFrames);
    TrackEstimate estimate = Compare(std::move(guess), map);
    Judge(estimate, prior, map);
    estimate.tracked = estimate.tracked &&
                       Spread(estimate.placed) >= settings_.min_relocalized_spread &&
                       (!may_be || may_be(estimate));
    if (estimate.tracked) return estimate;
    passing_.Clear();  // of a rejected pose
  }
  return lost;
}

TrackEstimate Tracker::PlaceAgain(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                                  KeyFrameId near) {
  const int most = most_inliers_;
  const KeyFrame* keyframe = map.Find(near);
  if (!keyframe) return {};
  const double seconds = std::abs(frame->time - keyframe->frame->time);
  const double prior =
      AfterSeconds(LogOdds(settings_.evidence.min_probability), seconds, settings_.evidence);
  TrackEstimate estimate = FindIn(frame, map, {&near, 1}, prior, {});
  most_inliers_ = most;
  return estimate;
}

// Root mean square distance of the matched keypoints from their mean, relative to the image
// diagonal.
double Tracker::Spread(const PlacedFrame& placed) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0, count = 0;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    if (!placed.matches[i].valid()) continue;
    sum += placed.frame->keypoints[i].pixel();
    squares += placed.frame->keypoints[i].pixel().squaredNorm();
    ++count;
  }
  if (count == 0) return 0;
  const double variance = squares / count - (sum / count).squaredNorm();
  return std::sqrt(std::max(0.0, variance)) / std::hypot(camera_.width, camera_.height);
}

void Tracker::CountExpected(const LocalMatches& found, const MapSnapshot& map,
                            TrackEstimate& estimate) const {
  const PartTimer timer(FramePart::kEvidence);
  const PlacedFrame& placed = estimate.placed;
  // The largest error of a match, σ: the search radius, or the gate of a bad frame.
  const double radius = has_depth_ ? settings_.local_radius_depth : settings_.local_radius;
  PoseEvidence evidence(*placed.frame, camera_.width, camera_.height, settings_.noise,
                        std::min(radius, kGate * settings_.bad_frame_sigma), has_depth_,
                        settings_.evidence);
  IdSet<LandmarkId> counted;
  for (size_t k = 0; k < found.matches.size(); ++k) {
    const LandmarkId id = found.matches[k];
    if (!id.valid()) continue;
    counted.Enter(id);
    estimate.sightings.push_back({id, placed.matches[k].valid()});
    const Keypoint& keypoint = placed.frame->keypoints[k];
    const Landmark* landmark = placed.matches[k].valid() ? map.Find(id) : nullptr;
    if (landmark) {
      const MatchError error = ErrorOf(placed, k, *landmark);
      evidence.Found(keypoint.x, keypoint.y, keypoint.level, error.chi2, error.chi2_disparity);
    } else {
      evidence.Missed(keypoint.x, keypoint.y, keypoint.level);
    }
  }
  for (const ExpectedLandmark& expected : found.visible) {
    if (counted.Contains(expected.landmark)) continue;
    estimate.sightings.push_back({expected.landmark, false});
    evidence.Missed(expected.u, expected.v, expected.level);
  }
  estimate.evidence = evidence.LogLikelihoodRatio();
}

double Tracker::Optimise(PlacedFrame& placed, const MapSnapshot& map) const {
  const PartTimer timer(FramePart::kPose);
  std::vector<PoseMatch> matches;
  std::vector<int> keypoints;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const Landmark* landmark = placed.matches[i].valid() ? map.Find(placed.matches[i]) : nullptr;
    if (!landmark) continue;
    const Measurement m = Measure(placed.frame->keypoints[i], settings_.noise);
    const double trust = placed.frame->Static(static_cast<int>(i)) * landmark->static_probability;
    matches.push_back({landmark->p_world, m.pixel, m.inv_sigma2, m.inv_sigma2_right, trust});
    keypoints.push_back(static_cast<int>(i));
  }
  const size_t landmarks = matches.size();
  for (const PassingMatch& match : placed.passing) {
    const Measurement m = Measure(placed.frame->keypoints[match.keypoint], settings_.noise);
    matches.push_back({match.p_world, m.pixel, m.inv_sigma2, m.inv_sigma2_right,
                       placed.frame->Static(match.keypoint)});
  }
  PoseOnlyResult result = OptimizePose(camera_, placed.T_camera_world, matches);
  const auto agreeing = [&] {  // landmarks only, without temporary points
    const auto end = result.inlier.begin() + static_cast<std::ptrdiff_t>(landmarks);
    return static_cast<int>(std::count(result.inlier.begin(), end, true));
  };
  const double enough = settings_.good_agreement * static_cast<double>(landmarks);
  if (agreeing() < enough && settings_.bad_frame_sigma > 1) {
    // Motion blur and rolling shutter distort whole frames. A wider gate uses the whole image
    // instead of only the part consistent with the first estimate.
    for (PoseMatch& match : matches)
      match.inv_sigma2 /= settings_.bad_frame_sigma * settings_.bad_frame_sigma;
    result = OptimizePose(camera_, placed.T_camera_world, matches);
  }
  placed.T_camera_world = result.T_camera_world;
  placed.covariance = result.covariance;
  placed.inliers = agreeing();
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (!result.inlier[i]) placed.matches[keypoints[i]] = {};
  }
  std::vector<PassingMatch> held;
  for (size_t i = 0; i < placed.passing.size(); ++i) {
    if (result.inlier[landmarks + i]) held.push_back(placed.passing[i]);
  }
  placed.passing = std::move(held);
  return landmarks == 0 ? 0 : placed.inliers / static_cast<double>(landmarks);
}

TrackEstimate Tracker::Estimate(PlacedFrame guess, const MapSnapshot& map) {
  TrackEstimate estimate = Compare(std::move(guess), map);
  const double time = estimate.placed.frame->time;
  Judge(estimate, AfterSeconds(belief_.log_odds, time - belief_.time, settings_.evidence), map);
  // What was not found is evidence that the camera is elsewhere.
  if (!estimate.tracked)
    belief_ = {std::max(estimate.placed.log_odds, LogOdds(settings_.evidence.found_again)), time};
  return estimate;
}

TrackEstimate Tracker::GoOn(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map) {
  TrackEstimate estimate = Estimate(Predict(frame, map), map);
  estimate.tracked =
      estimate.tracked && Spread(estimate.placed) >= settings_.min_relocalized_spread;
  if (!estimate.tracked) passing_.Clear();  // of a rejected pose
  return estimate;
}

TrackEstimate Tracker::Compare(PlacedFrame guess, const MapSnapshot& map) {
  TrackEstimate estimate;
  // Drop matches of the guess whose keypoints were classified as moving since.
  for (size_t k = 0; k < guess.matches.size(); ++k) {
    if (!guess.matches[k].valid() || guess.frame->IsUsable(static_cast<int>(k))) continue;
    guess.matches[k] = {};
    --guess.inliers;
  }
  const int enough_to_try = Scaled(settings_.min_after_prediction);
  if (guess.inliers < enough_to_try) {
    estimate.placed = std::move(guess);
    return estimate;
  }
  const LocalMap local =
      gatherer_.Gather(map, guess.matches, guess.T_camera_world, settings_.local_keyframes);
  LocalMatches found = MatchLocalMap(guess, local, camera_, settings_);
  guess.matches = found.matches;
  if (has_depth_) {
    const PartTimer timer(FramePart::kPassing);
    guess.passing = passing_.Find(guess, settings_.local_radius_depth, settings_.max_distance);
  }
  const double share = Optimise(guess, map);

  estimate.reference = local.reference;
  estimate.placed = std::move(guess);
  CountExpected(found, map, estimate);
  estimate.agreement = share;
  return estimate;
}

void Tracker::Judge(TrackEstimate& estimate, double prior, const MapSnapshot& map) {
  const PartTimer timer(FramePart::kEvidence);
  PlacedFrame& placed = estimate.placed;
  placed.log_odds = prior + estimate.evidence;
  const double expected = static_cast<double>(estimate.sightings.size());
  estimate.tracked = placed.inliers >= Scaled(settings_.min_tracked) &&
                     placed.inliers >= settings_.min_inlier_share * expected &&
                     placed.log_odds >= LogOdds(settings_.evidence.min_probability);
  if (!estimate.tracked) return passing_.Clear();
  most_inliers_ = std::max(most_inliers_, placed.inliers);
  estimate.wants_keyframe = placed.log_odds >= LogOdds(settings_.evidence.min_keyframe) &&
                            WantsKeyFrame(placed, estimate.agreement);
  if (has_depth_) passing_.Update(placed, map.corrections());
}

double Tracker::LeastInliers() const {
  return (has_depth_ ? settings_.keyframe_share_depth : settings_.keyframe_share_mono) *
         most_inliers_;
}

bool Tracker::WantsKeyFrame(const PlacedFrame& placed, double agreement) const {
  const int since = placed.frame->number - last_keyframe_number_;
  // A blurred or poorly fitting frame would distort the map. Wait for a better one unless tracking
  // is about to fail.
  if (agreement < settings_.min_agreement && placed.inliers > 2 * Scaled(settings_.min_tracked))
    return false;
  if (since >= settings_.max_keyframe_gap) return true;
  if (since < settings_.min_keyframe_gap) return false;
  if (placed.inliers < LeastInliers()) return true;
  if (!has_depth_) return false;
  int near_tracked = 0, near_new = 0;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    if (!placed.frame->keypoints[i].has_depth()) continue;
    if (placed.frame->Static(static_cast<int>(i)) < Frame::kMappable) continue;
    ++(placed.matches[i].valid() ? near_tracked : near_new);
  }
  return near_tracked < Scaled(kFewNear) && near_new > Scaled(70);
}

void Tracker::Remember(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map) {
  // Allocations come first, so that bad_alloc leaves the tracker unchanged.
  PlacedFrame copy = placed;
  const Anchor anchor = AnchorTo(map.state(), reference, placed.T_camera_world);
  KeepReference(placed, reference, map);
  unproven_ = last_.frame ? std::max(0, unproven_ - 1) : settings_.unconfirmed_frames;
  if (last_.frame && placed.frame->number > last_.frame->number) {
    const Se3 T_now_last = placed.T_camera_world * PoseOf(map.state(), last_anchor_).Inverse();
    motion_.Add(T_now_last, placed.frame->time - last_.frame->time);
  } else {
    motion_.Clear();
  }
  last_ = std::move(copy);
  last_anchor_ = anchor;
  last_version_ = map.version();
  belief_ = {placed.log_odds, placed.frame->time};
}

void Tracker::Reanchor(const MapSnapshot& map) {
  if (!map.Find(reference_.anchor.keyframe)) reference_ = {};
  if (!last_anchor_.keyframe.valid() || map.Find(last_anchor_.keyframe)) return;
  const KeyFrameId heir = Reanchored(map.state(), last_anchor_).keyframe;
  // Converts to current map units. AnchorTo() stores the scale of the new anchor, which changes by
  // the same factors from now on.
  motion_.Scale(map.ScaleOf(last_anchor_.keyframe) / last_anchor_.scale);
  last_anchor_ =
      heir.valid() ? AnchorTo(map.state(), heir, PoseOf(map.state(), last_anchor_)) : Anchor{};
}

void Tracker::Forget() {
  passing_.Clear();
  reference_ = {};
  last_ = {};
  motion_.Clear();
}

}  // namespace alidade
