#include "alidade/dynamics/dynamic_filter.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/dynamics/feature_belief.h"
#include "alidade/dynamics/flow_votes.h"
#include "alidade/features/depth_image.h"

namespace alidade {
namespace {

// Lower bound of the belief of cells without an object. It is above that of objects, so that past
// views distinguish them.
constexpr float kLeastGeometry = kObjectStatic + 0.1f;

}  // namespace

DynamicFilter::DynamicFilter(const Camera& camera, const DynamicsSettings& settings,
                             std::span<const std::string> class_names)
    : camera_(camera),
      settings_(settings),
      cells_(camera),
      objects_(settings, class_names),
      surfaces_(cells_, settings.surfaces, settings.depth),
      track_belief_(settings.tracks),
      history_(settings.history),
      belief_(Unknown()) {}

FrameBelief DynamicFilter::Unknown() const {
  FrameBelief belief;
  belief.geometry.assign(cells_.count(), kUnknownStatic);
  belief.object.assign(cells_.count(), 0);
  belief.resting.assign(cells_.count(), 0);
  belief.log_odds = belief.geometry;
  return belief;
}

void DynamicFilter::Advance(const DynamicInput& input,
                            const std::optional<FrameDetections>& arrived) {
  now_ = input;
  times_.push_front(input.time);
  if (times_.size() > FlowTracks::kHistory) times_.pop_back();
  tracks_.Advance(input.gray);
  // Until Judge() the belief of the previous frame applies, except for its depth.
  FrameBelief expected = belief_;
  expected.depth.clear();
  if (!input.depth.empty())
    expected.depth = DepthOfCells(cells_, camera_, input.depth, settings_.depth);
  if (!input.right.empty())
    expected.depth = StereoDepthOfCells(cells_, camera_, input.gray, input.right, settings_.depth);
  belief_ = std::move(expected);
  objects_.Advance(tracks_.tracks(), cells_, input.time, input.gray.size());
  if (arrived) {
    const int ago = input.number - arrived->number;
    const bool known = static_cast<size_t>(ago) < times_.size();
    objects_.Update(arrived->detections, ago, known ? times_[ago] : input.time, tracks_.tracks());
  }
}

cv::Mat DynamicFilter::ExpectedMovers() const {
  cv::Mat movers(cells_.rows(), cells_.columns(), CV_8U);
  // Without depth, geometry classifies single features but not the surfaces they are on.
  for (int i = 0; i < cells_.count(); ++i)
    movers.data[i] =
        belief_.object[i] || (!belief_.depth.empty() && belief_.log_odds[i] < 0) ? 255 : 0;
  return movers;
}

void DynamicFilter::Judge(Frame& frame, const PoseGuess* guess) {
  Judge(guess, true);
  frame.static_probability = StaticProbabilities(cells_, belief_, DepthImage(now_.depth, camera_),
                                                 frame.keypoints, settings_);
}

void DynamicFilter::JudgeTracks(const PoseGuess* guess) { Judge(guess, false); }

void DynamicFilter::Judge(const PoseGuess* guess, bool surfaces) {
  if (guess) Enter(guess->world);
  const GeometryBelief geometry = JudgeGeometry(guess, surfaces);
  FrameBelief judged = Unknown();
  judged.depth = belief_.depth;
  judged.geometry = geometry.log_odds;
  judged.votes = geometry.votes;
  FindObjects(geometry.proven, judged);
  if (settings_.weigh) objects_.JudgeRest(tracks_.tracks(), judged.votes, cells_);
  for (int i = 0; i < cells_.count(); ++i) {
    judged.log_odds[i] = judged.object[i] ? std::min(judged.geometry[i], judged.resting[i])
                                          : std::max(judged.geometry[i], kLeastGeometry);
  }
  belief_ = std::move(judged);
}

DynamicFilter::GeometryBelief DynamicFilter::JudgeGeometry(const PoseGuess* guess, bool surfaces) {
  GeometryBelief unchanged;
  unchanged.votes.assign(tracks_.tracks().size(), 0);
  unchanged.log_odds = belief_.geometry;
  if (!settings_.geometry) return unchanged;
  if (!belief_.depth.empty()) {
    if (guess) return JudgeWithDepth(*guess, surfaces);
    unchanged.log_odds.assign(cells_.count(), kUnknownStatic);
    return unchanged;
  }
  // A frame that lacks depth keeps the belief of the previous ones.
  const bool had_depth = surfaces_.number() >= now_.number - settings_.surfaces.gap;
  return had_depth ? unchanged : JudgeWithoutDepth(guess);
}

DynamicFilter::GeometryBelief DynamicFilter::JudgeWithDepth(const PoseGuess& guess, bool surfaces) {
  const std::vector<float>& depth = belief_.depth;
  GeometryBelief judged;
  judged.votes = Consensus(cells_, depth, tracks_.tracks(),
                           VoteByPose(camera_, cells_, tracks_.tracks(), guess.T_camera_world,
                                      history_, guess.nearest, settings_.votes),
                           settings_.votes, settings_.depth);
  if (!surfaces) {
    judged.log_odds.assign(cells_.count(), kUnknownStatic);
    return judged;
  }
  const std::vector<int> from = surfaces_.Carry(depth, guess.T_camera_world, history_);
  std::vector<uint8_t> resting(cells_.count(), 0), suspect(cells_.count(), 0);
  for (int i = 0; i < cells_.count(); ++i) {
    if (from[i] >= 0) resting[i] = belief_.object[from[i]];
  }
  for (const MovingObject& object : objects_.objects()) {
    if (object.carried) continue;
    for (int i : CellsInBox(cells_, object.box)) suspect[i] = 1;
  }
  surfaces_.Update(now_.number, depth, guess.T_camera_world, history_, resting, suspect,
                   tracks_.tracks(), judged.votes);
  judged.log_odds = surfaces_.log_odds();
  return judged;
}

DynamicFilter::GeometryBelief DynamicFilter::JudgeWithoutDepth(const PoseGuess* guess) {
  const std::vector<FlowTrack>& tracks = tracks_.tracks();
  std::vector<int8_t> votes;
  if (guess) {
    votes = VoteByPose(camera_, cells_, tracks, guess->T_camera_world, history_, guess->nearest,
                       settings_.votes);
  } else {
    std::vector<uint8_t> on_object;
    for (const FlowTrack& track : tracks)
      on_object.push_back(belief_.object[cells_.At(track.at().x, track.at().y)]);
    votes = VoteByAgreement(camera_, tracks, on_object,
                            settings_.seed + static_cast<uint64_t>(now_.number), settings_.votes);
  }
  GeometryBelief judged;
  judged.votes = Consensus(cells_, {}, tracks, votes, settings_.votes, settings_.depth);
  track_belief_.Update(tracks, judged.votes);
  judged.log_odds = track_belief_.OfCells(cells_, tracks);
  if (settings_.foreground) judged.proven = track_belief_.Proven(cells_, tracks);
  return judged;
}

void DynamicFilter::FindObjects(std::span<const uint8_t> proven, FrameBelief& judged) {
  for (MovingObject& object : objects_.objects()) {
    object.cells = !settings_.foreground  ? CellsInBox(cells_, object.box)
                   : judged.depth.empty() ? CellsInOval(cells_, object.box, proven, settings_.box)
                                          : FindForeground(cells_, judged.depth, judged.geometry,
                                                           object.box, settings_.box);
    if (object.carried && !IsCarried(object, judged.geometry)) continue;
    for (int i : object.cells) {
      judged.resting[i] = judged.object[i] ? std::min(judged.resting[i], object.static_log_odds)
                                           : object.static_log_odds;
      judged.object[i] = 1;
    }
  }
}

// A portable object moves as a whole: true when more than carried_share of its cells move.
bool DynamicFilter::IsCarried(const MovingObject& object, std::span<const float> geometry) const {
  const auto moving = std::count_if(object.cells.begin(), object.cells.end(),
                                    [&](int i) { return geometry[i] < 0; });
  return static_cast<double>(moving) >
         settings_.objects.carried_share * static_cast<double>(object.cells.size());
}

double DynamicFilter::RivalShare() const {
  const uint64_t seed = settings_.seed + static_cast<uint64_t>(now_.number);
  return ShareOfRivalMotion(camera_, cells_, tracks_.tracks(), belief_.votes, seed,
                            settings_.votes);
}

double DynamicFilter::MovedShare() const {
  const auto moved = std::count(belief_.votes.begin(), belief_.votes.end(), int8_t{-1});
  const auto stood = std::count(belief_.votes.begin(), belief_.votes.end(), int8_t{1});
  if (moved + stood < settings_.votes.agreement_tracks) return 0;
  return static_cast<double>(moved) / static_cast<double>(moved + stood);
}

void DynamicFilter::Forget() {
  history_.Clear();
  track_belief_ = TrackBelief(settings_.tracks);
  belief_.geometry.assign(cells_.count(), kUnknownStatic);
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
    view->depth = belief_.depth;
    view->static_log_odds = belief_.log_odds;
    for (int i = 0; i < cells_.count(); ++i) {
      if (belief_.object[i])
        view->static_log_odds[i] = kObjectStatic;  // a resting object is not background
    }
  }
  history_.Add(std::move(view));
}

Sight DynamicFilter::Look(const Eigen::Vector3d& p) const {
  return SightOf(cells_, belief_, p, settings_.landmarks, settings_.depth);
}

cv::Mat DynamicFilter::BeliefOfCells() const {
  return cv::Mat(cells_.rows(), cells_.columns(), CV_32F,
                 const_cast<float*>(belief_.log_odds.data()))
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
