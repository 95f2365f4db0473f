#include "alidade/tracking/mono_start.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/settings_table.h"
#include "alidade/features/glance.h"

namespace alidade {
namespace {

// Spatial extent of points: the area of their one-sigma ellipse divided by π.
struct Extent {
  double count = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();

  void Add(const Eigen::Vector2d& p) {
    ++count;
    sum += p;
    squares += p * p.transpose();
  }
  double Area() const {
    if (count < 3) return 0;
    const Eigen::Vector2d mean = sum / count;
    return std::sqrt(std::max(0.0, (squares / count - mean * mean.transpose()).determinant()));
  }
};

}  // namespace

std::span<const Setting> MonoStartSettings::Table() {
  using T = MonoStartSettings;
  static constexpr Setting kRows[] = {
      SameSetting<&T::match_scale>("match_scale", {.min = 0, .max = 4, .open_min = true}),
      PublicSetting<&T::min_depth_landmarks>("start.min_depth_landmarks", AtLeast(20), "landmarks",
                                             "Stereo and RGB-D: landmarks with depth that the "
                                             "first frame must have, per 1000 features."),
      PublicSetting<&T::min_matches>(
          "start.min_matches", AtLeast(20), "matches",
          "One camera: with fewer matches a reference frame is given up, per 1000 features."),
      PublicSetting<&T::trial_frames>("start.trial_frames", kPositive, "frames",
                                      "One camera: frames that must confirm a new map."),
      ExpertSetting<&T::trial_share>(
          "start.trial_share", kZeroToOne, "",
          "Share of the landmarks expected in view that must be tracked in each of them."),
      ExpertSetting<&T::reference_gap>("start.reference_gap", kPositive, "frames",
                                       "Frames between two reference frames."),
      ExpertSetting<&T::window>(
          "start.window", kPositiveShare, "",
          "Largest motion of a keypoint between two frames, as a share of the image width."),
      ExpertSetting<&T::max_still_share>(
          "start.max_still_share", kPositiveShare, "",
          "No start when more than this share of the matches does not move: the camera is "
          "stationary."),
      ExpertSetting<&T::max_still_picture>(
          "start.max_still_picture", kPositive, "",
          "No start when more than this share of the image edges does not move."),
      ExpertSetting<&T::min_still_motion>("start.min_still_motion", kPositive, "",
                                          "Motion of the landmarks, as a share of the image width, "
                                          "after which an unconfirmed map is "
                                          "tested for a stationary camera."),
      ExpertSetting<&T::min_still_frames>(
          "start.min_still_frames", kPositive, "frames",
          "Frames that must show a stationary camera for such a map to be dropped."),
  };
  return kRows;
}

void MonoStartSettings::Check() const {
  CheckRanges(*this);
  two_view.Check();
  if (!(min_motion >= 0 && min_motion < window))
    ThrowUsage("setting expert.start.window must exceed MonoStartSettings::min_motion");
}

MonoStart::Step MonoStart::StepOf(TwoViewFailure failure) {
  switch (failure) {
    case TwoViewFailure::kNone:
      return Step::kStarts;
    case TwoViewFailure::kLowParallax:
      return Step::kLowParallax;
    case TwoViewFailure::kUnknownLens:
      return Step::kUnknownLens;
    case TwoViewFailure::kAmbiguous:
      return Step::kAmbiguous;
    case TwoViewFailure::kTooFewMatches:
      return Step::kFewMatches;
    case TwoViewFailure::kNoModel:
    case TwoViewFailure::kTooFewPoints:
      break;
  }
  return Step::kNoModel;
}

MonoStart::MonoStart(const Camera& camera, MonoStartSettings settings)
    : camera_(camera), settings_(settings) {
  settings_.Check();
}

bool MonoStart::StandsStill(std::span<const Eigen::Vector2d> a,
                            std::span<const Eigen::Vector2d> b) const {
  const double near = settings_.still_pixels;
  Extent still, around, rest;
  for (size_t i = 0; i < a.size(); ++i) {
    const double moved = (a[i] - b[i]).norm();
    (moved < near ? still : moved < 2 * near ? around : rest).Add(a[i]);
  }
  return still.count >= settings_.max_still_share * static_cast<double>(a.size()) &&
         still.count > settings_.min_still_peak * around.count &&
         still.Area() >= settings_.min_still_area * rest.Area();
}

bool MonoStart::PictureStays(const Frame& a, const Frame& b) const {
  return StillShare(a.glance, b.glance) >= settings_.max_still_picture;
}

MonoStart::Step MonoStart::Try(Reference& reference, const std::shared_ptr<const Frame>& frame,
                               MonoStartResult& result) const {
  MatchSettings matching;
  matching.ratio = 0.9;
  const auto radius = static_cast<float>(settings_.window * camera_.width);
  const std::vector<IndexMatch> matches =
      MatchWindow(*reference.frame, *frame, reference.guess, radius, matching);
  if (static_cast<double>(matches.size()) < settings_.min_matches * settings_.match_scale)
    return Step::kFewMatches;
  std::vector<Eigen::Vector2d> pixels_a, pixels_b;
  std::vector<double> motion;
  for (const IndexMatch& match : matches) {
    const Keypoint &a = reference.frame->keypoints[match.a], &b = frame->keypoints[match.b];
    reference.guess[match.a] = {b.x, b.y};
    pixels_a.push_back(a.pixel());
    pixels_b.push_back(b.pixel());
    motion.push_back((a.pixel() - b.pixel()).norm());
  }
  if (UpperMedian(motion) < settings_.min_motion * camera_.width) return Step::kLittleMotion;
  const TwoViewResult views = ReconstructTwoViews(camera_, pixels_a, pixels_b, settings_.two_view);
  if (views.failure != TwoViewFailure::kNone) return StepOf(views.failure);
  if (StandsStill(pixels_a, pixels_b) || PictureStays(*reference.frame, *frame))
    return Step::kStillCamera;
  result.a = reference.frame;
  result.b = frame;
  result.T_b_a = views.T_b_a;
  result.parallax_degrees = views.parallax_degrees;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (views.inlier[i]) result.points.push_back({views.p_a[i], matches[i].a, matches[i].b});
  }
  return Step::kStarts;
}

std::optional<MonoStartResult> MonoStart::Add(std::shared_ptr<const Frame> frame) {
  farthest_ = Step::kFewCorners;
  if (static_cast<double>(frame->keypoints.size()) < settings_.min_matches * settings_.match_scale)
    return {};
  farthest_ = references_.empty() ? Step::kNoFrame : Step::kFewMatches;
  std::vector<Reference> kept;
  for (Reference& reference : references_) {
    MonoStartResult tried;
    Step step = Try(reference, frame, tried);
    if (step == Step::kStillCamera) still_ = frame->number;
    if (step == Step::kStarts && still_ && frame->number - *still_ <= settings_.still_memory)
      step = Step::kStillCamera;
    farthest_ = std::max(farthest_, step);
    if (step == Step::kStarts) {  // the oldest reference has the most parallax
      references_.clear();
      return tried;
    }
    if (step != Step::kFewMatches) kept.push_back(std::move(reference));
  }
  references_ = std::move(kept);
  if (references_.empty() ||
      frame->number - references_.back().frame->number >= settings_.reference_gap) {
    // Old references have the most parallax, so the newest one is replaced.
    if (static_cast<int>(references_.size()) >= settings_.references) references_.pop_back();
    Reference reference{frame, {}};
    for (const Keypoint& keypoint : frame->keypoints)
      reference.guess.push_back({keypoint.x, keypoint.y});
    references_.push_back(std::move(reference));
  }
  return {};
}

TrackFailure MonoStart::failure() const {
  switch (farthest_) {
    case Step::kNoFrame:
      return TrackFailure::kFirstView;
    case Step::kFewCorners:
      return TrackFailure::kFewCorners;
    case Step::kFewMatches:
      return TrackFailure::kFewMatches;
    case Step::kLittleMotion:
      return TrackFailure::kLittleMotion;
    case Step::kNoModel:
      return TrackFailure::kNoMotionModel;
    case Step::kLowParallax:
      return TrackFailure::kLowParallax;
    case Step::kUnknownLens:
      return TrackFailure::kPureRotation;
    case Step::kAmbiguous:
      return TrackFailure::kTwoMotions;
    case Step::kStillCamera:
      return TrackFailure::kStillCamera;
    case Step::kStarts:
      break;
  }
  return TrackFailure::kNone;
}

}  // namespace alidade
