#include "alidade/dynamics/dynamic_filter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

constexpr float kDefault = 1.5f;  // log-odds of what nothing is known of: 0.82
constexpr float kCertain = 5;     // bound of all log-odds
constexpr float kForget = 0.01f;  // share of the way back to the default, per frame
constexpr float kObject = -4;     // of what a detector knows to move
constexpr int kOlderStep = 10;    // frames from one older view to the next
constexpr size_t kOlder = 9;

float Probability(float log_odds) { return 1 / (1 + std::exp(-log_odds)); }

}  // namespace

DynamicFilter::DynamicFilter(const Camera& camera, const DynamicsSettings& settings,
                             std::span<const std::string> class_names)
    : camera_(camera),
      settings_(settings),
      cells_(camera),
      objects_(settings, class_names),
      belief_(cells_.count(), kDefault),
      object_(cells_.count(), 0) {}

void DynamicFilter::Advance(const DynamicInput& input,
                            const std::optional<FrameDetections>& arrived) {
  now_ = input;
  tracks_.Advance(input.gray);
  depth_.clear();
  if (!input.depth.empty()) depth_ = DepthOfCells(cells_, camera_, input.depth);
  if (!input.right.empty()) depth_ = StereoDepthOfCells(cells_, camera_, input.gray, input.right);

  objects_.Advance(tracks_.tracks(), cells_, input.time, input.gray.size());
  if (arrived) {
    const int ago = input.number - arrived->number;
    objects_.Update(arrived->detections, ago, input.time, tracks_.tracks(), cells_);
  }
  std::fill(object_.begin(), object_.end(), uint8_t{0});
  for (MovingObject& object : objects_.objects()) {
    object.cells = FindForeground(
        cells_, settings_.foreground ? std::span<const float>(depth_) : std::span<const float>(),
        object.box);
    if (object.carried) continue;
    for (int i : object.cells) object_[i] = 1;
  }
}

cv::Mat DynamicFilter::ExpectedMovers() const {
  cv::Mat movers(cells_.rows(), cells_.columns(), CV_8U);
  for (int i = 0; i < cells_.count(); ++i) movers.data[i] = belief_[i] < 0 || object_[i] ? 255 : 0;
  return movers;
}

// What a cell shows now was believed to move or not where it was in the last frame, had it stood
// still: movers are large against what they move in a frame.
void DynamicFilter::CarryBelief(const Se3* T_camera_world) {
  std::vector<float> carried(cells_.count(), kDefault);
  const PastView* last = recent_.empty() ? nullptr : recent_.front().get();
  if (T_camera_world && last && !depth_.empty() && !last->depth.empty()) {
    const DepthComparison then = CompareDepth(cells_, depth_, *T_camera_world, *last);
    for (int i = 0; i < cells_.count(); ++i) {
      if (then.met[i] >= 0) carried[i] = belief_[then.met[i]];
      if (!(depth_[i] > 0)) carried[i] = belief_[i];
    }
  } else {
    carried = belief_;
  }
  for (float& b : carried) b += kForget * (kDefault - b);
  belief_ = std::move(carried);
}

void DynamicFilter::AddDepthEvidence(const Se3& T_camera_world, std::vector<float>& evidence,
                                     std::vector<float>& weights) const {
  constexpr float kFree = -1.5f, kSame = 0.15f;  // log-odds, per frame
  std::vector<float> same(cells_.count(), 0);
  std::vector<int> free(cells_.count(), 0), seen(cells_.count(), 0);
  const auto compare = [&](const std::shared_ptr<const PastView>& past) {
    if (!past || past->depth.empty()) return;
    const DepthComparison comparison = CompareDepth(cells_, depth_, T_camera_world, *past);
    const float age = std::min(1.0f, static_cast<float>(now_.number - past->number) / 30);
    for (int i = 0; i < cells_.count(); ++i) {
      seen[i] += comparison.result[i] != Comparison::kUnknown;
      free[i] += comparison.result[i] == Comparison::kFree;
      if (comparison.result[i] == Comparison::kSame) {
        // What moved then and is still there has only stopped.
        const float trust = Probability(past->static_log_odds[comparison.met[i]]);
        same[i] = std::max(same[i], age * trust);
      }
    }
  };
  for (size_t ago : {size_t{6}, size_t{15}}) {
    if (recent_.size() > ago) compare(recent_[ago]);
  }
  for (size_t k : {size_t{0}, size_t{3}, size_t{8}}) {
    if (older_.size() > k) compare(older_[k]);
  }
  for (int i = 0; i < cells_.count(); ++i) {
    if (seen[i] == 0) continue;
    weights[i] += 1;
    evidence[i] += free[i] > 0 ? kFree : kSame * same[i];
  }
}

void DynamicFilter::AddFlowEvidence(const Se3& T_camera_world, std::vector<float>& evidence,
                                    std::vector<float>& weights) {
  constexpr int kMostAgo = 15;
  constexpr double kSigma = 1.2;  // pixels: flow and predicted pose
  for (const FlowTrack& track : tracks_.tracks()) {
    // Of the frames it was seen in, the oldest with a known pose: the most parallax.
    int ago = std::min(track.length() - 1, kMostAgo);
    while (ago >= 2 && (static_cast<int>(recent_.size()) < ago || !recent_[ago - 1])) --ago;
    if (ago < 2) continue;
    const PastView& past = *recent_[ago - 1];
    const cv::Point2f then = track.Before(ago);
    const Eigen::Vector2d pixel_then = camera_.Undistort({then.x, then.y});
    const Eigen::Vector2d pixel_now = camera_.Undistort({track.at().x, track.at().y});
    double least = 0, most = 1 / 0.4;
    const int cell_then = cells_.At(then.x, then.y);
    if (!past.depth.empty() && past.depth[cell_then] > 0) {
      float nearest = past.depth[cell_then], farthest = nearest;
      cells_.VisitAround(cell_then, 1, [&](int n) {
        if (!(past.depth[n] > 0)) return;
        nearest = std::min(nearest, past.depth[n]);
        farthest = std::max(farthest, past.depth[n]);
      });
      least = 1 / (1.03 * farthest + 0.02);
      most = 1 / (0.97 * nearest - 0.02);
    }
    const EpipolarSegment segment =
        SegmentOf(camera_, camera_.Unproject(pixel_then),
                  T_camera_world * past.T_camera_world.Inverse(), least, most);
    const double off = segment.in_front ? DistanceTo(segment, pixel_now) / kSigma : 5;
    const auto e = static_cast<float>(std::clamp(0.15 * (1 - off * off / 4), -1.5, 0.1));
    const int cell = cells_.At(track.at().x, track.at().y);
    evidence[cell] += e;
    weights[cell] += 1;
  }
}

void DynamicFilter::Judge(Frame& frame, const Se3* T_camera_world) {
  CarryBelief(T_camera_world);
  if (settings_.geometry && T_camera_world) {
    std::vector<float> evidence(cells_.count(), 0), weights(cells_.count(), 0);
    if (!depth_.empty()) AddDepthEvidence(*T_camera_world, evidence, weights);
    AddFlowEvidence(*T_camera_world, evidence, weights);
    for (int i = 0; i < cells_.count(); ++i) {
      if (weights[i] > 0) evidence[i] /= weights[i];
    }
    SpreadOverSurfaces(cells_, depth_, evidence, weights);
    for (int i = 0; i < cells_.count(); ++i)
      belief_[i] = std::clamp(belief_[i] + std::min(1.0f, 2 * weights[i]) * evidence[i], -kCertain,
                              kCertain);
  }
  for (int i = 0; i < cells_.count(); ++i) {
    if (object_[i]) belief_[i] = std::min(belief_[i], kObject);
  }
  frame.static_probability.resize(frame.keypoints.size());
  for (size_t k = 0; k < frame.keypoints.size(); ++k) {
    const float p = Probability(BeliefAt(frame.keypoints[k]));
    frame.static_probability[k] = settings_.weigh ? p : p >= Frame::kMappable ? 1.0f : 0.0f;
    if (p > 0.8f) frame.static_probability[k] = 1;
  }
}

// Of the cell with the keypoint's depth; where its depth is not known, the worst around it: an
// outline moves with what it is the outline of.
float DynamicFilter::BeliefAt(const Keypoint& keypoint) const {
  const int cell = cells_.At(keypoint.raw_x, keypoint.raw_y);
  if (depth_.empty()) return belief_[cell];
  float belief = belief_[cell], least = 1e9f;
  cells_.VisitAround(cell, 1, [&](int n) {
    if (!keypoint.has_depth()) {
      belief = std::min(belief, belief_[n]);
    } else if (depth_[n] > 0 && std::abs(depth_[n] - keypoint.depth) < least) {
      least = std::abs(depth_[n] - keypoint.depth);
      belief = belief_[n];
    }
  });
  return belief;
}

void DynamicFilter::Remember(const Frame& frame, const Se3* T_camera_world, uint64_t corrections) {
  if (corrections != corrections_) {  // earlier poses are no longer in this world
    recent_.clear();
    older_.clear();
    corrections_ = corrections;
  }
  tracks_.Seed(frame.keypoints, now_.gray.size());
  std::shared_ptr<PastView> view;
  if (T_camera_world) {
    view = std::make_shared<PastView>();
    view->number = now_.number;
    view->T_camera_world = *T_camera_world;
    view->depth = depth_;
    view->static_log_odds = belief_;
  }
  recent_.push_front(std::move(view));
  if (static_cast<int>(recent_.size()) > FlowTracks::kHistory) {
    const auto last = recent_.back();
    recent_.pop_back();
    if (last && (older_.empty() || last->number - older_.front()->number >= kOlderStep)) {
      older_.push_front(last);
      if (older_.size() > kOlder) older_.pop_back();
    }
  }
}

cv::Mat DynamicFilter::Mask() const {
  cv::Mat small(cells_.rows(), cells_.columns(), CV_32F, const_cast<float*>(belief_.data()));
  cv::Mat large, mask;
  cv::resize(small, large, {camera_.width, camera_.height}, 0, 0, cv::INTER_LINEAR);
  cv::compare(large, 0, mask, cv::CMP_LT);
  return mask;
}

}  // namespace alidade
