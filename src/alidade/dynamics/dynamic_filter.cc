#include "alidade/dynamics/dynamic_filter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

constexpr float kDefault = 1.5f;    // log-odds of what nothing is known of: 0.82
constexpr float kCertain = 5;       // bound of all log-odds
constexpr float kForget = 0.01f;    // share of the way back to the default, per frame
constexpr float kRemember = 0.95f;  // of certainty, per frame
constexpr float kLearn = 0.3f;
constexpr float kObject = -4;   // of what a detector knows to move
constexpr int kOlderStep = 10;  // frames from one older view to the next
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
      certainty_(cells_.count(), 0),
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
}

// What each object covers of the picture.
void DynamicFilter::FindObjects() {
  std::fill(object_.begin(), object_.end(), uint8_t{0});
  const bool cut = settings_.foreground && !depth_.empty();
  for (MovingObject& object : objects_.objects()) {
    object.cells =
        cut ? FindForeground(cells_, depth_, belief_, object.box) : CellsInOval(cells_, object.box);
    if (object.carried) continue;
    for (int i : object.cells) object_[i] = 1;
  }
}

float DynamicFilter::Belief(int cell) const {
  return object_[cell] ? kObject : std::max(belief_[cell], kObject + 0.1f);
}

cv::Mat DynamicFilter::ExpectedMovers() const {
  cv::Mat movers(cells_.rows(), cells_.columns(), CV_8U);
  for (int i = 0; i < cells_.count(); ++i) movers.data[i] = belief_[i] < 0 || object_[i] ? 255 : 0;
  return movers;
}

// What a cell shows now was believed to move or not where it was in the last frame, had it stood
// still: movers are large against what they move in a frame.
// What a cell shows now was believed to move or not where it was in the last frame, had it stood
// still: movers are large against what they move in a frame.
void DynamicFilter::CarryBelief(const Se3* T_camera_world) {
  std::vector<float> belief(cells_.count(), kDefault), certainty(cells_.count(), 0);
  const PastView* last = recent_.empty() ? nullptr : recent_.front().get();
  if (T_camera_world && last && !depth_.empty() && !last->depth.empty()) {
    const DepthComparison then = CompareDepth(cells_, depth_, *T_camera_world, *last);
    std::vector<uint8_t> object(cells_.count(), 0);
    for (int i = 0; i < cells_.count(); ++i) {
      const int from = then.met[i];
      if (from < 0) continue;
      belief[i] = belief_[from];
      certainty[i] = certainty_[from];
      object[i] = object_[from];
    }
    object_ = std::move(object);
  } else {
    belief = belief_;
    certainty = certainty_;
  }
  for (float& b : belief) b += kForget * (kDefault - b);
  for (float& c : certainty) c *= kRemember;
  belief_ = std::move(belief);
  certainty_ = std::move(certainty);
}

// What stands where one looked through before has come since; what was there a while ago already
// and was not thought to move stands still.
void DynamicFilter::AddDepthEvidence(const Se3& T_camera_world, std::vector<float>& evidence,
                                     std::vector<float>& weights) const {
  constexpr float kFree = -1.5f, kSame = 0.2f;  // log-odds, per frame
  constexpr float kSettled = 75,
                  kRested = 0.5f;  // frames after which a mover that stays has come to rest
  constexpr float kTrusted = 0.4f;
  std::vector<float> same(cells_.count(), 0);
  std::vector<uint8_t> free(cells_.count(), 0);
  const auto compare = [&](const std::shared_ptr<const PastView>& past) {
    if (!past || past->depth.empty()) return;
    const DepthComparison comparison = CompareDepth(cells_, depth_, T_camera_world, *past);
    const auto frames = static_cast<float>(now_.number - past->number);
    const float age = std::min(1.0f, frames / 30), least = frames >= kSettled ? kRested : 0;
    for (int i = 0; i < cells_.count(); ++i) {
      free[i] |= comparison.result[i] == Comparison::kFree;
      if (comparison.result[i] != Comparison::kSame) continue;
      const float trust = std::max(least, Probability(past->static_log_odds[comparison.met[i]]));
      same[i] = std::max(same[i], age * trust);
    }
  };
  for (size_t k : {size_t{8}, size_t{5}, size_t{2}, size_t{0}}) {
    if (older_.size() > k) compare(older_[k]);
  }
  for (size_t ago : {size_t{15}, size_t{6}}) {
    if (recent_.size() > ago) compare(recent_[ago]);
  }
  for (int i = 0; i < cells_.count(); ++i) {
    const bool moved = free[i] && same[i] < kTrusted;
    const float weight = moved ? 1 : same[i];
    weights[i] += weight;
    evidence[i] += weight * (moved ? kFree : kSame);
  }
}

void DynamicFilter::AddFlowEvidence(const Se3& T_camera_world, std::vector<float>& evidence,
                                    std::vector<float>& weights) {
  constexpr int kMostAgo = 15;
  constexpr double kMoved = 3;         // pixels off where it should be …
  constexpr double kShare = 0.15;      // … and of the way it went
  constexpr int kReach = 3;            // cells around
  constexpr float kSurface = 0.06f;    // of the depth
  constexpr float kEnough = 3;         // tracks
  constexpr float kAgreed = 0.4f;      // mean vote
  constexpr float kConfirmed = 0.06f;  // evidence of depth that it stands still
  constexpr float kMovedEvidence = -0.5f, kStoodEvidence = 0.02f;  // log-odds, per frame and track
  std::vector<float> votes(cells_.count(), 0), counts(cells_.count(), 0);
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
    const double off = segment.in_front ? DistanceTo(segment, pixel_now) : 1e9;
    // What errors of depth and pose do to it grows with the way it went.
    const double way = (pixel_now - pixel_then).norm();
    const double moved = kMoved + kShare * way;
    const int cell = cells_.At(track.at().x, track.at().y);
    votes[cell] += off > moved ? -1.0f : off < moved / 2 ? 1.0f : 0.0f;
    counts[cell] += 1;
  }
  // One track may slip; a surface has several.
  const auto together = [&](int a, int b) {
    return depth_.empty() || !(depth_[a] > 0) || !(depth_[b] > 0) ||
           std::abs(depth_[a] - depth_[b]) < kSurface * depth_[a];
  };
  for (int i = 0; i < cells_.count(); ++i) {
    if (counts[i] == 0) continue;
    float sum = 0, count = 0;
    cells_.VisitAround(i, kReach, [&](int n) {
      if (counts[n] == 0 || !together(i, n)) return;
      sum += votes[n];
      count += counts[n];
    });
    if (count < kEnough) continue;
    const bool moved = sum<-kAgreed * count, stood = sum> kAgreed * count;
    if (!moved && !stood) continue;
    cells_.VisitAround(i, 1, [&](int n) {
      if (!together(i, n) || (moved && evidence[n] > kConfirmed)) return;
      evidence[n] += moved ? kMovedEvidence : kStoodEvidence;
      weights[n] += moved ? 1.0f : 0.2f;
    });
  }
}

// What little is known of takes after the surface it is on.
void DynamicFilter::SpreadBelief() {
  constexpr float kFade = 0.75f, kRate = 0.3f;  // share of the way, per frame
  std::vector<float> values = belief_, weights(cells_.count());
  for (int i = 0; i < cells_.count(); ++i) weights[i] = certainty_[i] * certainty_[i];
  SpreadOverSurfaces(cells_, depth_, kFade, values, weights);
  for (int i = 0; i < cells_.count(); ++i) {
    const float share = kRate * (1 - certainty_[i]) * std::min(1.0f, 20 * weights[i]);
    belief_[i] += share * (values[i] - belief_[i]);
  }
}

void DynamicFilter::Judge(Frame& frame, const Se3* T_camera_world) {
  CarryBelief(T_camera_world);
  if (settings_.geometry && T_camera_world) {
    std::vector<float> evidence(cells_.count(), 0), weights(cells_.count(), 0);
    if (!depth_.empty()) AddDepthEvidence(*T_camera_world, evidence, weights);
    AddFlowEvidence(*T_camera_world, evidence, weights);
    for (int i = 0; i < cells_.count(); ++i) {
      if (object_[i] && evidence[i] > 0) continue;  // it only rests
      belief_[i] = std::clamp(belief_[i] + evidence[i], -kCertain, kCertain);
      certainty_[i] = std::min(1.0f, certainty_[i] + kLearn * weights[i]);
    }
    SpreadBelief();
  }
  FindObjects();
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
  if (depth_.empty()) return Belief(cell);
  float belief = Belief(cell), least = 1e9f;
  cells_.VisitAround(cell, 1, [&](int n) {
    if (!keypoint.has_depth()) {
      belief = std::min(belief, Belief(n));
    } else if (depth_[n] > 0 && std::abs(depth_[n] - keypoint.depth) < least) {
      least = std::abs(depth_[n] - keypoint.depth);
      belief = Belief(n);
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
    view->static_log_odds.resize(cells_.count());
    for (int i = 0; i < cells_.count(); ++i) view->static_log_odds[i] = Belief(i);
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
  cv::Mat small(cells_.rows(), cells_.columns(), CV_32F);
  for (int i = 0; i < cells_.count(); ++i) small.ptr<float>()[i] = Belief(i);
  cv::Mat large, mask;
  cv::resize(small, large, {camera_.width, camera_.height}, 0, 0, cv::INTER_LINEAR);
  cv::compare(large, 0, mask, cv::CMP_LT);
  return mask;
}

}  // namespace alidade
