// Frames between extracted ones: the landmarks of the last extracted frame are aligned with the
// image (FrameAlignment), instead of extracting and matching features.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/base/part_times.h"
#include "alidade/features/rolling_shutter.h"
#include "alidade/features/undistort.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

float WrappedAngle(float angle) {
  constexpr float kPi = std::numbers::pi_v<float>;
  return angle > kPi ? angle - 2 * kPi : angle <= -kPi ? angle + 2 * kPi : angle;
}

}  // namespace

void Tracker::KeepReference(const PlacedFrame& placed, KeyFrameId keyframe,
                            const MapSnapshot& map) {
  if (!settings_.align || extracted_.empty() || placed.frame->number != extracted_number_) return;
  const KeyFrame* found = map.Find(keyframe);
  reference_.frame = placed.frame;
  reference_.matches = placed.matches;
  reference_.anchor = AnchorTo(map.state(), keyframe, placed.T_camera_world);
  reference_.is_keyframe = found && found->frame->number == placed.frame->number;
  reference_.inliers = placed.inliers;
  reference_.most_found = 0;
  alignment_.SetReference(extracted_, placed.frame->keypoints.size());
  extracted_.release();
}

// The landmarks that the reference frame shows. A keyframe's may have been added since.
std::vector<LandmarkId> Tracker::ReferenceMatches(const MapSnapshot& map) const {
  const KeyFrame* keyframe =
      reference_.is_keyframe ? map.Find(reference_.anchor.keyframe) : nullptr;
  if (keyframe && keyframe->landmarks.size() == reference_.matches.size())
    return keyframe->landmarks;
  return reference_.matches;
}

std::optional<TrackEstimate> Tracker::Align(const cv::Mat& image, const cv::Mat& depth, double time,
                                            int number, const MapSnapshot& map) {
  if (!reference_.frame || !alignment_.has_reference() || !last_.frame) return std::nullopt;
  if (number - reference_.frame->number >= settings_.max_keyframe_gap || unproven_ > 0 ||
      time - last_.frame->time > settings_.max_motion_age || !map.Find(reference_.anchor.keyframe))
    return std::nullopt;
  const Frame& before = *reference_.frame;
  std::vector<LandmarkId> matches = ReferenceMatches(map);
  std::vector<ReferencePoint> points;
  std::vector<LandmarkId> ids;
  for (size_t k = 0; k < matches.size(); ++k) {
    const LandmarkId id = matches[k] = map.Current(matches[k]);
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    const Keypoint& keypoint = before.keypoints[k];
    points.push_back({landmark->p_world,
                      {keypoint.raw_x, keypoint.raw_y},
                      keypoint.level,
                      static_cast<int>(k)});
    ids.push_back(id);
  }
  reference_.matches = std::move(matches);  // older ids are released
  PlacedFrame placed;
  placed.T_camera_world = MotionUntil(time, map) * PoseOf(map.state(), last_anchor_);
  const std::vector<AlignedPoint> aligned =
      alignment_.Align(camera_, image, points, PoseOf(map.state(), reference_.anchor),
                       placed.T_camera_world);

  auto frame = std::make_shared<Frame>();
  frame->time = time;
  frame->number = number;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!aligned[i].found) continue;
    Keypoint keypoint = before.keypoints[points[i].keypoint];
    keypoint.raw_x = aligned[i].raw.x();
    keypoint.raw_y = aligned[i].raw.y();
    keypoint.angle = WrappedAngle(keypoint.angle + aligned[i].turn);
    keypoint.depth = keypoint.right_x = Keypoint::kNoDepth;
    frame->keypoints.push_back(keypoint);
    frame->descriptors.push_back(before.descriptors[points[i].keypoint]);
    placed.matches.push_back(ids[i]);
  }
  UndistortKeypoints(camera_, *frame);
  if (!depth.empty()) {
    const PartTimer timer(FramePart::kDepth);
    frame->image = image;
    AttachDepth(depth, camera_, *frame, settings_.depth_range);
    frame->image.release();
  }
  UndoShutter(*frame, map);
  placed.frame = frame;
  return JudgeAligned(std::move(placed), *frame, points, ids, aligned, map);
}

std::optional<TrackEstimate> Tracker::JudgeAligned(PlacedFrame placed, Frame& frame,
                                                   std::span<const ReferencePoint> points,
                                                   std::span<const LandmarkId> ids,
                                                   std::span<const AlignedPoint> aligned,
                                                   const MapSnapshot& map) {
  TrackEstimate estimate;
  estimate.agreement = Optimise(placed, map);
  estimate.reference = reference_.anchor.keyframe;
  estimate.placed = std::move(placed);
  if (camera_.RollingShutter()) UndoShutter(frame, estimate, map);

  const PartTimer timer(FramePart::kEvidence);
  const PlacedFrame& result = estimate.placed;
  constexpr double kGate = 2.448;  // root of chi², 95 % with 2 degrees of freedom
  PoseEvidence evidence(camera_.width, camera_.height, kGate * settings_.bad_frame_sigma,
                        settings_.evidence);
  int near_tracked = 0;
  for (size_t i = 0, k = 0; i < points.size(); ++i) {
    if (!aligned[i].expected) continue;
    bool found = false;
    const Keypoint& before = reference_.frame->keypoints[points[i].keypoint];
    const Landmark* landmark = map.Find(ids[i]);
    if (aligned[i].found) {
      found = result.matches[k].valid();
      if (found && landmark) {
        const MatchError error = ErrorOf(result, k, *landmark);
        evidence.Found(frame.keypoints[k].x, frame.keypoints[k].y, before.level, error.chi2, -1);
        near_tracked += before.has_depth();
      }
      ++k;
    }
    if (!found && landmark) {
      const Eigen::Vector2d pixel = camera_.Project(result.T_camera_world * landmark->p_world);
      evidence.Missed(pixel.x(), pixel.y(), before.level);
    }
    estimate.sightings.push_back({ids[i], found});
  }
  estimate.evidence = evidence.LogLikelihoodRatio();
  estimate.placed.log_odds =
      AfterSeconds(belief_.log_odds, frame.time - belief_.time, settings_.evidence) +
      estimate.evidence;
  reference_.most_found = std::max(reference_.most_found, result.inliers);
  // As many as an extraction would find, if it loses the same share.
  const double expected = static_cast<double>(result.inliers) / std::max(1, reference_.most_found) *
                          reference_.inliers;
  const double share = has_depth_ ? settings_.keyframe_share_depth : settings_.keyframe_share_mono;
  const bool few = expected < share * std::max(most_inliers_, reference_.inliers) ||
                   result.inliers < 2 * Scaled(settings_.min_tracked) ||
                   (has_depth_ && near_tracked < Scaled(100));
  if (few || estimate.agreement < settings_.good_agreement ||
      result.log_odds < LogOdds(settings_.evidence.min_probability))
    return std::nullopt;
  estimate.tracked = true;
  return estimate;
}

}  // namespace alidade
