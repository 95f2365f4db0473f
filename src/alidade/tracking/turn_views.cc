#include "alidade/tracking/turn_views.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "alidade/features/matching.h"
#include "alidade/geometry/rotation_fit.h"
#include "alidade/geometry/se3.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t kMostViews = 24;   // a circle of views 15 degrees apart
constexpr double kApart = 0.25;     // of the image's width: a camera turned further is a new view
constexpr double kPoor = 0.01;      // radians: a view that tells the rotation less well is left
constexpr int kFewestInliers = 30;  // of 1000 features
constexpr double kResidualPixels = 0.5;  // at least: corners are placed to 0.3 to 0.5 pixels
// Standard deviation of the rotation over the residual (Seen::covariance): of noise, in which half
// a pixel of parallax may be hidden, and of the parallax beyond it.
constexpr double kOfNoise = 2, kOfParallax = 5;
// Half-width of the search, as a share of the image's width: where the turn is known to a degree,
// and where the camera turns as before with 20 rad/s² more at 30 images per second.
constexpr double kNear = 0.02, kFar = 0.06;

Vector3d DirectionOf(const Keypoint& keypoint, const Camera& camera) {
  return camera.Unproject(keypoint.pixel()).normalized();
}

std::shared_ptr<const Frame> WithoutImages(const Frame& frame) {
  auto kept = std::make_shared<Frame>();
  kept->time = frame.time;
  kept->number = frame.number;
  kept->keypoints = frame.keypoints;
  kept->descriptors = frame.descriptors;
  kept->static_probability = frame.static_probability;
  kept->grid = frame.grid;
  return kept;
}

}  // namespace

void TurnViews::Reset() {
  views_.clear();
  R_start_last_ = last_turn_ = Matrix3d::Identity();
}

void TurnViews::Turned(const Matrix3d& R_start_camera) {
  R_start_last_ = R_start_camera;
  ++spot_;
}

TurnViews::View* TurnViews::Nearest(const Matrix3d& R_start_camera) {
  View* nearest = nullptr;
  double least = 0;
  for (View& view : views_) {
    const double angle = LogSo3(view.R_start_view.transpose() * R_start_camera).norm();
    if (nearest && angle >= least) continue;
    nearest = &view;
    least = angle;
  }
  return nearest;
}

std::optional<TurnViews::Seen> TurnViews::Compare(const View& view, const Frame& frame,
                                                  const Camera& camera,
                                                  const Matrix3d& R_view_camera,
                                                  double radius) const {
  const std::vector<Keypoint>& keypoints = view.frame->keypoints;
  std::vector<Eigen::Vector2f> guess(keypoints.size());
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const Vector3d p = R_view_camera.transpose() * DirectionOf(keypoints[i], camera);
    const Eigen::Vector2d pixel = p.z() > 0.1 ? camera.Project(p) : Eigen::Vector2d(-1e4, -1e4);
    guess[i] = pixel.cast<float>();
  }
  const std::vector<IndexMatch> matches =
      MatchWindow(*view.frame, frame, guess, static_cast<float>(radius), {.ratio = 0.9});
  std::vector<Vector3d> a, b;
  for (const IndexMatch& match : matches) {
    if (!view.frame->IsUsable(match.a) || !frame.IsUsable(match.b)) continue;
    a.push_back(DirectionOf(keypoints[match.a], camera));
    b.push_back(DirectionOf(frame.keypoints[match.b], camera));
  }
  if (static_cast<double>(a.size()) < kFewestInliers * match_scale_) return std::nullopt;
  const double noise = kResidualPixels / camera.fx;
  const RotationFit fit = FitRotation(a, b, R_view_camera, noise);
  const double enough =
      std::max(kFewestInliers * match_scale_, 0.5 * static_cast<double>(a.size()));
  if (fit.inliers < enough) return std::nullopt;
  const double parallax = std::sqrt(std::max(0.0, fit.residual * fit.residual - noise * noise));
  const double sigma = std::hypot(kOfNoise * fit.residual, kOfParallax * parallax);
  Seen seen{view.id, fit.R_a_b, {}, sigma, view.spot == spot_};
  const double angle = LogSo3(fit.R_a_b).norm() * camera.focal_sigma;
  seen.covariance =
      sigma * sigma * fit.information.inverse() + angle * angle * Matrix3d::Identity();
  return seen;
}

std::optional<int> TurnViews::MakeRoom() {
  if (views_.size() < kMostViews) return std::nullopt;
  const auto least = std::min_element(views_.begin(), views_.end(),
                                      [](const View& a, const View& b) { return a.uses < b.uses; });
  const int id = least->id;
  views_.erase(least);
  return id;
}

TurnViews::Step TurnViews::Add(const Frame& frame, const Camera& camera,
                               const std::optional<Matrix3d>& turn) {
  Step step;
  const Matrix3d turned = R_start_last_ * turn.value_or(last_turn_);
  const Matrix3d guess = Eigen::Quaterniond(turned).normalized().toRotationMatrix();
  step.R_start_camera = guess;
  bool tells = false, near = false;
  if (View* view = Nearest(guess)) {
    const Matrix3d R_view_camera = view->R_start_view.transpose() * guess;
    step.seen = Compare(*view, frame, camera, R_view_camera, (turn ? kNear : kFar) * camera.width);
    if (step.seen) {
      ++view->uses;
      step.known = true;
      step.R_start_camera = view->R_start_view * step.seen->R_view_camera;
      const double apart = LogSo3(step.seen->R_view_camera).norm() * camera.fx;
      near = apart < kApart * camera.width;
      tells = step.seen->covariance(0, 0) < kPoor * kPoor;
    }
  } else {
    step.known = true;  // the start
  }
  if (!(near && tells) &&
      static_cast<double>(frame.keypoints.size()) >= 2 * kFewestInliers * match_scale_) {
    step.dropped = MakeRoom();
    step.added = next_++;
    step.new_spot = !tells || !step.seen->at_spot;
    if (step.new_spot) ++spot_;
    views_.push_back({*step.added, WithoutImages(frame), step.R_start_camera, spot_});
  }
  last_turn_ =
      step.known ? (R_start_last_.transpose() * step.R_start_camera).eval() : Matrix3d::Identity();
  R_start_last_ = step.R_start_camera;
  return step;
}

}  // namespace alidade
