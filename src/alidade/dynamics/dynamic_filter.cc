#include "alidade/dynamics/dynamic_filter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/log_odds.h"
#include "alidade/dynamics/evidence.h"
#include "alidade/dynamics/flow_votes.h"
#include "alidade/features/depth_image.h"

namespace alidade {
namespace {

constexpr float kSure = 0.8f;  // probability from which a feature counts fully

}  // namespace

DynamicFilter::DynamicFilter(const Camera& camera, const DynamicsSettings& settings,
                             std::span<const std::string> class_names)
    : camera_(camera),
      settings_(settings),
      cells_(camera),
      objects_(settings, class_names),
      surfaces_(cells_),
      geometry_(cells_.count(), kUnknownStatic),
      object_(cells_.count(), 0),
      resting_(cells_.count(), 0),
      belief_(geometry_) {}

void DynamicFilter::Advance(const DynamicInput& input,
                            const std::optional<FrameDetections>& arrived) {
  now_ = input;
  times_.push_front(input.time);
  if (times_.size() > FlowTracks::kHistory) times_.pop_back();
  tracks_.Advance(input.gray);
  depth_.clear();
  if (!input.depth.empty()) depth_ = DepthOfCells(cells_, camera_, input.depth);
  if (!input.right.empty()) depth_ = StereoDepthOfCells(cells_, camera_, input.gray, input.right);
  objects_.Advance(tracks_.tracks(), cells_, input.time, input.gray.size());
  if (arrived) {
    const int ago = input.number - arrived->number;
    const bool known = static_cast<size_t>(ago) < times_.size();
    objects_.Update(arrived->detections, ago, known ? times_[ago] : input.time, tracks_.tracks());
  }
}

cv::Mat DynamicFilter::ExpectedMovers() const {
  cv::Mat movers(cells_.rows(), cells_.columns(), CV_8U);
  // Without depth geometry tells single features, not what they are on.
  for (int i = 0; i < cells_.count(); ++i)
    movers.data[i] = object_[i] || (!depth_.empty() && belief_[i] < 0) ? 255 : 0;
  return movers;
}

// What each object covers of the picture. `proven`: cells (nonzero) that stand still for certain,
// which only the rim of a box can hold; may be empty.
void DynamicFilter::FindObjects(std::span<const uint8_t> proven) {
  std::fill(object_.begin(), object_.end(), uint8_t{0});
  for (MovingObject& object : objects_.objects()) {
    object.cells = !settings_.foreground ? CellsInBox(cells_, object.box)
                   : depth_.empty()      ? CellsInOval(cells_, object.box, proven)
                                         : FindForeground(cells_, depth_, geometry_, object.box);
    if (object.carried && !IsCarried(object)) continue;
    for (int i : object.cells) {
      resting_[i] =
          object_[i] ? std::min(resting_[i], object.static_log_odds) : object.static_log_odds;
      object_[i] = 1;
    }
  }
}

// A chair moves as a whole: when a good part of it is seen to, all of it does.
bool DynamicFilter::IsCarried(const MovingObject& object) const {
  constexpr double kPart = 0.4;
  const auto moving = std::count_if(object.cells.begin(), object.cells.end(),
                                    [&](int i) { return geometry_[i] < 0; });
  return static_cast<double>(moving) > kPart * static_cast<double>(object.cells.size());
}

void DynamicFilter::JudgeWithDepth(const PoseGuess& guess) {
  const std::vector<int> from = surfaces_.Carry(depth_, guess.T_camera_world, history_);
  std::vector<uint8_t> resting(cells_.count(), 0), suspect(cells_.count(), 0);
  for (int i = 0; i < cells_.count(); ++i) {
    if (from[i] >= 0) resting[i] = object_[from[i]];
  }
  for (const MovingObject& object : objects_.objects()) {
    if (object.carried) continue;
    for (int i : CellsInBox(cells_, object.box)) suspect[i] = 1;
  }
  votes_ = Consensus(
      cells_, depth_, tracks_.tracks(),
      VoteByPose(camera_, cells_, tracks_.tracks(), guess.T_camera_world, history_, guess.nearest));
  surfaces_.Update(now_.number, depth_, guess.T_camera_world, history_, resting, suspect,
                   tracks_.tracks(), votes_);
  geometry_ = surfaces_.log_odds();
}

void DynamicFilter::JudgeWithoutDepth(const PoseGuess* guess) {
  const std::vector<FlowTrack>& tracks = tracks_.tracks();
  if (guess) {
    votes_ = VoteByPose(camera_, cells_, tracks, guess->T_camera_world, history_, guess->nearest);
  } else {
    std::vector<uint8_t> on_object;
    for (const FlowTrack& track : tracks)
      on_object.push_back(object_[cells_.At(track.at().x, track.at().y)]);
    votes_ = VoteByAgreement(camera_, tracks, on_object,
                             settings_.seed + static_cast<uint64_t>(now_.number));
  }
  votes_ = Consensus(cells_, {}, tracks, votes_);
  track_belief_.Update(tracks, votes_);
  geometry_ = track_belief_.OfCells(cells_, tracks);
}

void DynamicFilter::Judge(Frame& frame, const PoseGuess* guess) {
  std::vector<uint8_t> proven;
  votes_.assign(tracks_.tracks().size(), 0);
  if (guess) Enter(guess->world);
  if (settings_.geometry) {
    if (!depth_.empty() && guess) JudgeWithDepth(*guess);
    if (!depth_.empty() && !guess) std::fill(geometry_.begin(), geometry_.end(), kUnknownStatic);
    // A frame that comes without depth keeps what the last ones said.
    const bool had_depth = surfaces_.number() >= now_.number - SurfaceBelief::kGap;
    if (depth_.empty() && !had_depth) {
      JudgeWithoutDepth(guess);
      if (settings_.foreground) proven = track_belief_.Proven(cells_, tracks_.tracks());
    }
  }
  FindObjects(proven);
  if (settings_.weigh) objects_.JudgeRest(tracks_.tracks(), votes_, cells_);
  for (int i = 0; i < cells_.count(); ++i) {
    belief_[i] = object_[i] ? std::min(geometry_[i], resting_[i])
                            : std::max(geometry_[i], kObjectStatic + 0.1f);
  }
  frame.static_probability.resize(frame.keypoints.size());
  for (size_t k = 0; k < frame.keypoints.size(); ++k) {
    float p = ProbabilityOf(BeliefAt(frame.keypoints[k]));
    if (!settings_.weigh) p = p >= Frame::kMappable ? 1.0f : 0.0f;
    frame.static_probability[k] = p > kSure ? 1 : p;
  }
  if (settings_.weigh) FeedTheStarving(frame);
}

// Where too few certain features are left, what may stand still has a small say rather than
// nothing: better a pose that leans on them a little than none.
void DynamicFilter::FeedTheStarving(Frame& frame) const {
  constexpr float kEnough = 0.15f;  // of the features …
  constexpr float kLeast = 120;     // … and so many at least, are certain
  constexpr float kSmall = 0.15f;   // say of the others
  const auto certain = static_cast<float>(
      std::count_if(frame.static_probability.begin(), frame.static_probability.end(),
                    [](float p) { return p >= Frame::kMappable; }));
  const auto all = static_cast<float>(frame.keypoints.size());
  if (certain >= kEnough * all && certain >= std::min(kLeast, all / 2)) return;
  for (size_t k = 0; k < frame.keypoints.size(); ++k) {
    const Keypoint& keypoint = frame.keypoints[k];
    const int cell = cells_.At(keypoint.raw_x, keypoint.raw_y);
    if (geometry_[cell] < 0) continue;  // seen to move
    frame.static_probability[k] = std::max(frame.static_probability[k], kSmall);
  }
}

// Metres at a pixel of the depth image; 0 where there is no reading.
float DynamicFilter::DepthAt(int x, int y) const {
  return DepthImage(now_.depth, camera_).At(x, y);
}

// Log-odds of the surface that has depth z at a cell: of the cells around the one nearest in depth;
// where all of them show something else (a chair's back, with someone behind it), the worst of
// those farther off that have it. `otherwise` where none has.
float DynamicFilter::BeliefOfSurface(int cell, float z, float otherwise) const {
  constexpr float kSurface = 0.08f;  // of the depth
  constexpr int kFar = 6;            // cells
  float belief = otherwise, least = kSurface * z;
  cells_.VisitAround(cell, 1, [&](int n) {
    if (!(depth_[n] > 0) || std::abs(depth_[n] - z) >= least) return;
    least = std::abs(depth_[n] - z);
    belief = belief_[n];
  });
  if (least < kSurface * z) return belief;
  bool known = false;
  cells_.VisitAround(cell, kFar, [&](int n) {
    if (!(depth_[n] > 0) || std::abs(depth_[n] - z) >= kSurface * z) return;
    belief = known ? std::min(belief, belief_[n]) : belief_[n];
    known = true;
  });
  return belief;
}

// Of the surface the keypoint is on; where its depth is not known, the worst around it: an outline
// moves with what it is the outline of.
float DynamicFilter::BeliefAt(const Keypoint& keypoint) const {
  constexpr int kReach = 2;  // pixels, to the next reading
  const int cell = cells_.At(keypoint.raw_x, keypoint.raw_y);
  if (depth_.empty()) return belief_[cell];
  float lowest = belief_[cell];
  cells_.VisitAround(cell, 1, [&](int n) { lowest = std::min(lowest, belief_[n]); });
  const float otherwise = lowest >= 0 ? belief_[cell] : lowest;
  if (keypoint.has_depth()) return BeliefOfSurface(cell, keypoint.depth, otherwise);
  if (now_.depth.empty()) return otherwise;
  const int x = static_cast<int>(std::lround(keypoint.raw_x));
  const int y = static_cast<int>(std::lround(keypoint.raw_y));
  const float here = DepthAt(x, y);
  if (here > 0) return BeliefOfSurface(cell, here, otherwise);
  float belief = 0;
  bool known = false;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const float z = DepthAt(x + dx, y + dy);
      if (!(z > 0)) continue;
      const float of_it = BeliefOfSurface(cell, z, otherwise);
      belief = known ? std::min(belief, of_it) : of_it;
      known = true;
    }
  }
  return known ? belief : otherwise;
}

bool DynamicFilter::FollowsMover() const {
  constexpr double kMost = 0.55;
  const uint64_t seed = settings_.seed + static_cast<uint64_t>(now_.number);
  return ShareOfRivalMotion(camera_, cells_, tracks_.tracks(), votes_, seed) > kMost;
}

void DynamicFilter::Forget() {
  history_.Clear();
  track_belief_ = {};
  std::fill(geometry_.begin(), geometry_.end(), kUnknownStatic);
}

void DynamicFilter::Enter(const WorldId& world) {
  if (!(world == world_)) history_.Clear();
  world_ = world;
}

void DynamicFilter::Remember(const Frame& frame, const Se3* T_camera_world, const WorldId& world) {
  if (T_camera_world) Enter(world);
  tracks_.Seed(frame.keypoints, now_.gray.size());
  std::shared_ptr<PastView> view;
  if (T_camera_world) {
    view = std::make_shared<PastView>();
    view->number = now_.number;
    view->T_camera_world = *T_camera_world;
    view->depth = depth_;
    view->static_log_odds = belief_;
    for (int i = 0; i < cells_.count(); ++i) {
      if (object_[i]) view->static_log_odds[i] = kObjectStatic;  // what rests is no background
    }
  }
  history_.Add(std::move(view));
}

Sight DynamicFilter::Look(const Eigen::Vector3d& p) const {
  constexpr int kEnough = 5;  // neighbours with depth
  const int cell = cells_.Project(p);
  if (cell < 0) return Sight::kClear;
  if (depth_.empty()) return belief_[cell] < 0 ? Sight::kHidden : Sight::kClear;
  const auto z = static_cast<float>(p.z());
  const float tolerance = DepthTolerance(z);
  int known = 0, behind = 0;
  bool still = false, mover = false;
  cells_.VisitAround(cell, 1, [&](int n) {
    if (!(depth_[n] > 0)) return;
    ++known;
    behind += depth_[n] > z + 2 * tolerance;
    if (std::abs(depth_[n] - z) > tolerance) return;
    (belief_[n] < 0 ? mover : still) = true;
  });
  if (still || known < kEnough) return Sight::kClear;
  if (mover) return Sight::kOnMover;
  return behind == known ? Sight::kGone : Sight::kHidden;
}

cv::Mat DynamicFilter::BeliefOfCells() const {
  return cv::Mat(cells_.rows(), cells_.columns(), CV_32F, const_cast<float*>(belief_.data()))
      .clone();
}

cv::Mat DynamicFilter::Mask() const {
  return MaskOf(BeliefOfCells(), {camera_.width, camera_.height});
}

cv::Mat MaskOf(const cv::Mat& belief_of_cells, cv::Size size) {
  cv::Mat large, mask;
  cv::resize(belief_of_cells, large, size, 0, 0, cv::INTER_LINEAR);
  cv::compare(large, 0, mask, cv::CMP_LT);
  return mask;
}

}  // namespace alidade
