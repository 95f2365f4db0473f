// Frames between extracted ones: the landmarks of the last extracted frame are aligned with the
// image (FrameAlignment), instead of extracting and matching features.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "alidade/base/part_times.h"
#include "alidade/features/mask.h"
#include "alidade/features/undistort.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

constexpr double kNotExtrapolated = std::numeric_limits<double>::infinity();

float WrappedAngle(float angle) {
  constexpr float kPi = std::numbers::pi_v<float>;
  return angle > kPi ? angle - 2 * kPi : angle <= -kPi ? angle + 2 * kPi : angle;
}

}  // namespace

void Tracker::KeepReference(const PlacedFrame& placed, KeyFrameId keyframe,
                            const MapSnapshot& map) {
  if (extracted_.empty() || placed.frame->number != extracted_number_) return;
  const KeyFrame* found = map.Find(keyframe);
  reference_ = {};
  alignment_.SetReference(extracted_, placed.frame->keypoints.size());
  reference_.frame = placed.frame;
  reference_.matches = placed.matches;
  reference_.anchor = AnchorTo(map.state(), keyframe, placed.T_camera_world);
  reference_.is_keyframe = found && found->frame->number == placed.frame->number;
  reference_.inliers = placed.inliers;
  extracted_.release();
}

// The landmarks of the reference frame. A keyframe may have got more since.
Tracker::ReferenceView Tracker::ViewReference(const MapSnapshot& map) {
  const KeyFrame* keyframe =
      reference_.is_keyframe ? map.Find(reference_.anchor.keyframe) : nullptr;
  if (keyframe && keyframe->landmarks.size() == reference_.matches.size())
    reference_.matches = keyframe->landmarks;
  ReferenceView view;
  view.T_camera_world = PoseOf(map.state(), reference_.anchor);
  for (size_t k = 0; k < reference_.matches.size(); ++k) {
    LandmarkId& id = reference_.matches[k];
    id = map.Current(id);  // older ids are released
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const Keypoint& keypoint = reference_.frame->keypoints[k];
    const Eigen::Vector3d p = view.T_camera_world * landmark->p_world;
    if (!(p.z() > 0)) continue;
    const Eigen::Vector2d error = camera_.Project(p) - keypoint.pixel();
    const double sigma = settings_.noise.sigma_px * ScaleOfLevel(keypoint.level);
    if (!(error.norm() <= kGate * settings_.bad_frame_sigma * sigma)) continue;
    view.points.push_back(
        {landmark->p_world, {keypoint.raw_x, keypoint.raw_y}, keypoint.level, static_cast<int>(k)});
    view.landmarks.push_back(landmark);
    view.errors.push_back(error.cast<float>());
  }
  return view;
}

std::optional<TrackEstimate> Tracker::Align(const cv::Mat& image, const cv::Mat& depth, double time,
                                            int number, const cv::Mat& left_out,
                                            const MapSnapshot& map) {
  if (!reference_.frame || !last_.frame || unproven_ > 0 ||
      number - reference_.frame->number >= settings_.max_keyframe_gap ||
      !(time - last_.frame->time <= settings_.max_motion_age) ||
      !map.Find(reference_.anchor.keyframe))
    return std::nullopt;
  const ReferenceView view = ViewReference(map);
  PlacedFrame placed;
  placed.T_camera_world = MotionUntil(time, map) * PoseOf(map.state(), last_anchor_);
  std::vector<AlignedPoint> aligned =
      alignment_.Align(camera_, image, view.points, view.T_camera_world, placed.T_camera_world,
                       motion_.known() ? time - last_.frame->time : kNotExtrapolated);
  for (AlignedPoint& point : aligned) {
    if (point.found && Marks(left_out, point.raw.x(), point.raw.y(), camera_)) point = {};
  }

  auto frame = std::make_shared<Frame>();
  frame->time = time;
  frame->number = number;
  placed.frame = frame;
  AddAligned(view, aligned, *frame, placed.matches);
  if (!depth.empty()) {
    const PartTimer timer(FramePart::kDepth);
    ReadDepths(depth, camera_, *frame, settings_.depth_range);
  }
  UndoShutter(*frame, placed, map);
  TrackEstimate estimate;
  estimate.moved = MoveByErrors(view, aligned, *frame);
  estimate.reference = reference_.anchor.keyframe;
  estimate.agreement = Optimise(placed, map);
  estimate.placed = std::move(placed);
  CountAligned(view, aligned, estimate);
  if (!SufficesAligned(estimate)) return std::nullopt;
  estimate.tracked = true;
  return estimate;
}

// Sets the frame's keypoints, and their landmarks.
void Tracker::AddAligned(const ReferenceView& view, std::span<const AlignedPoint> aligned,
                         Frame& frame, std::vector<LandmarkId>& matches) const {
  const Frame& before = *reference_.frame;
  for (size_t i = 0; i < aligned.size(); ++i) {
    if (!aligned[i].found) continue;
    const auto k = static_cast<size_t>(view.points[i].keypoint);
    Keypoint keypoint = before.keypoints[k];
    keypoint.raw_x = aligned[i].raw.x();
    keypoint.raw_y = aligned[i].raw.y();
    keypoint.angle = WrappedAngle(keypoint.angle + aligned[i].turn);
    keypoint.depth = keypoint.right_x = Keypoint::kNoDepth;
    frame.keypoints.push_back(keypoint);
    frame.descriptors.push_back(before.descriptors[k]);
    matches.push_back(view.landmarks[i]->id);
  }
  UndistortKeypoints(camera_, frame);
}

// A keypoint of the reference is some tenths of a pixel beside its landmark's projection, and what
// is aligned with it is beside it by as much. Taking this error off makes the pose relative to the
// reference as precise as the alignment. Returns what was added, one per keypoint.
std::vector<Eigen::Vector2f> Tracker::MoveByErrors(const ReferenceView& view,
                                                   std::span<const AlignedPoint> aligned,
                                                   Frame& frame) {
  std::vector<Eigen::Vector2f> moved;
  for (size_t i = 0; i < aligned.size(); ++i) {
    if (!aligned[i].found) continue;
    Keypoint& keypoint = frame.keypoints[moved.size()];
    keypoint.x += view.errors[i].x();
    keypoint.y += view.errors[i].y();
    if (keypoint.has_depth()) keypoint.right_x += view.errors[i].x();
    moved.push_back(view.errors[i]);
  }
  return moved;
}

// Sets the sightings and the evidence. The covariance is that of keypoints that were not moved by
// MoveByErrors(): their errors tell how well the landmarks are known.
void Tracker::CountAligned(const ReferenceView& view, std::span<const AlignedPoint> aligned,
                           TrackEstimate& estimate) const {
  const PartTimer timer(FramePart::kEvidence);
  PlacedFrame& placed = estimate.placed;
  const Frame& frame = *placed.frame;
  PoseEvidence evidence(camera_.width, camera_.height, kGate * settings_.bad_frame_sigma,
                        settings_.evidence);
  double moved2 = 0, unmoved2 = 0;  // sums of squared errors
  size_t k = 0;
  for (size_t i = 0; i < aligned.size(); ++i) {
    if (!aligned[i].expected) continue;
    const Landmark& landmark = *view.landmarks[i];
    const int level = view.points[i].level;
    const Eigen::Vector2d expected = camera_.Project(placed.T_camera_world * landmark.p_world);
    const bool found = aligned[i].found && placed.matches[k].valid();
    if (found) {
      const MatchError error = ErrorOf(placed, k, landmark);
      evidence.Found(frame.keypoints[k].x, frame.keypoints[k].y, level, error.chi2, -1);
      const Eigen::Vector2d moved = frame.keypoints[k].pixel() - expected;
      const double weight = 1 / (ScaleOfLevel(level) * ScaleOfLevel(level));
      moved2 += weight * moved.squaredNorm();
      unmoved2 += weight * (moved - view.errors[i].cast<double>()).squaredNorm();
    } else {
      evidence.Missed(expected.x(), expected.y(), level);
    }
    k += aligned[i].found;
    estimate.sightings.push_back({landmark.id, found});
  }
  if (moved2 > 0) placed.covariance *= std::max(1.0, unmoved2 / moved2);
  estimate.evidence = evidence.LogLikelihoodRatio();
  placed.log_odds = AfterSeconds(belief_.log_odds, frame.time - belief_.time, settings_.evidence) +
                    estimate.evidence;
}

// Whether the frame needs no features of its own: its pose is right, and it is no keyframe.
bool Tracker::SufficesAligned(const TrackEstimate& estimate) {
  const PlacedFrame& placed = estimate.placed;
  reference_.most_found = std::max(reference_.most_found, placed.inliers);
  if (estimate.agreement < settings_.good_agreement ||
      placed.inliers < 2 * Scaled(settings_.min_tracked) ||
      placed.log_odds < LogOdds(settings_.evidence.min_probability))
    return false;
  const int of_reference = std::max(reference_.inliers, reference_.most_found);
  if (reference_.is_keyframe) most_inliers_ = std::max(most_inliers_, of_reference);
  // What an extraction would find, if it lost the same share of what it found in the reference.
  const double left = static_cast<double>(placed.inliers) / reference_.most_found;
  const double expected = left * of_reference;
  if (expected < LeastInliers()) return false;
  if (!has_depth_) return true;
  int near = 0;
  for (size_t k = 0; k < reference_.matches.size(); ++k)
    near += reference_.matches[k].valid() && reference_.frame->keypoints[k].has_depth();
  return near * left >= Scaled(kFewNear);
}

}  // namespace alidade
