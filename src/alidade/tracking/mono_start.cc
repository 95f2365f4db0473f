#include "alidade/tracking/mono_start.h"

#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/median.h"

namespace alidade {

void MonoStartSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("start.") + what);
  };
  two_view.Check();
  require(min_depth_landmarks >= 20, "min_depth_landmarks must be at least 20");
  require(min_matches >= 20, "min_matches must be at least 20");
  require(match_scale > 0 && match_scale <= 4, "match_scale must lie in (0, 4]");
  require(references >= 1 && reference_gap >= 1, "references and reference_gap must be positive");
  require(window > 0 && window <= 1, "window must lie in (0, 1]");
  require(min_motion >= 0 && min_motion < window, "min_motion must lie in [0, window)");
  require(trial_frames >= 0 && trial_share >= 0 && trial_share <= 1,
          "trial_share must lie in [0, 1]");
}

MonoStart::MonoStart(const Camera& camera, MonoStartSettings settings)
    : camera_(camera), settings_(settings) {
  settings_.Check();
}

std::optional<MonoStartResult> MonoStart::Try(Reference& reference,
                                              const std::shared_ptr<const Frame>& frame,
                                              bool& lost) {
  MatchSettings matching;
  matching.ratio = 0.9;
  const auto radius = static_cast<float>(settings_.window * camera_.width);
  const std::vector<IndexMatch> matches =
      MatchWindow(*reference.frame, *frame, reference.guess, radius, matching);
  lost = static_cast<double>(matches.size()) < settings_.min_matches * settings_.match_scale;
  if (lost) {
    reason_ = "too few matches between frames";
    return {};
  }
  std::vector<Eigen::Vector2d> pixels_a, pixels_b;
  std::vector<double> motion;
  for (const IndexMatch& match : matches) {
    const Keypoint &a = reference.frame->keypoints[match.a], &b = frame->keypoints[match.b];
    reference.guess[match.a] = {b.x, b.y};
    pixels_a.push_back(a.pixel());
    pixels_b.push_back(b.pixel());
    motion.push_back((a.pixel() - b.pixel()).norm());
  }
  if (UpperMedian(motion) < settings_.min_motion * camera_.width) {
    reason_ = "the camera hardly moves";
    return {};
  }
  const TwoViewResult views = ReconstructTwoViews(camera_, pixels_a, pixels_b, settings_.two_view);
  switch (views.failure) {
    case TwoViewFailure::kNone:
      break;
    case TwoViewFailure::kLowParallax:
      reason_ = "too little parallax: move the camera sideways";
      return {};
    case TwoViewFailure::kAmbiguous:
      reason_ = "two motions explain what is seen";
      return {};
    case TwoViewFailure::kTooFewMatches:
      reason_ = "too few matches between frames";
      return {};
    case TwoViewFailure::kNoModel:
    case TwoViewFailure::kTooFewPoints:
      reason_ = "too few points agree on one motion";
      return {};
  }
  MonoStartResult result;
  result.a = reference.frame;
  result.b = frame;
  result.T_b_a = views.T_b_a;
  result.parallax_degrees = views.parallax_degrees;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (views.inlier[i]) result.points.push_back({views.p_a[i], matches[i].a, matches[i].b});
  }
  return result;
}

std::optional<MonoStartResult> MonoStart::Add(std::shared_ptr<const Frame> frame) {
  if (static_cast<double>(frame->keypoints.size()) <
      settings_.min_matches * settings_.match_scale) {
    reason_ = "too few corners in the image";
    return {};
  }
  std::optional<MonoStartResult> result;
  std::vector<Reference> kept;
  for (Reference& reference : references_) {
    bool lost = false;
    if (!result) result = Try(reference, frame, lost);
    if (!lost) kept.push_back(std::move(reference));
  }
  references_ = std::move(kept);
  if (references_.empty() ||
      frame->number - references_.back().frame->number >= settings_.reference_gap) {
    // The oldest pairs have the most parallax; a newer one gives way.
    if (static_cast<int>(references_.size()) >= settings_.references) references_.pop_back();
    Reference reference{frame, {}};
    for (const Keypoint& keypoint : frame->keypoints)
      reference.guess.push_back({keypoint.x, keypoint.y});
    references_.push_back(std::move(reference));
  }
  return result;
}

}  // namespace alidade
