// Which map the camera is in: what is known of it, what the one before tells of the sensor, and how
// the two are joined.
#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/inertial/map_bridge.h"
#include "alidade/map/view.h"
#include "alidade/system/inertial/inertial_watch.h"

namespace alidade {
namespace {

// A dead-reckoned position is of use up to this standard deviation, as a share of the distance of
// what is seen: 5 degrees. Maps are joined up to the same.
constexpr double kOfUse = 0.09;
// What one map tells of the sensor holds in the next, but not better than this: temperature and
// flexing change it.
constexpr double kRotationHolds = 3e-3, kArmHolds = 5e-3, kClockHolds = 1e-3;  // rad, m, s
constexpr double kGyroHolds = 1e-3, kAccelHolds = 0.03;                        // rad/s, m/s²
constexpr const char* kNoScale = "scale is not observable yet";
// Relative standard deviation of the lengths of a loaded map in meters, at least: drift.
constexpr double kLeastScale = 2e-3;

}  // namespace

void InertialWatch::ForgetMap() {
  fit_.reset();
  accepted_.reset();
  doubtful_ = false;
  agreed_until_ = doubted_until_ = kNever;
  reckoner_.Forget();
  ahead_.Forget();
  past_.clear();
  known_scale_ = 0;
  report_.metric = false;
  report_.gravity.reset();
  report_.scale_sigma = report_.gravity_sigma = 0;
  report_.missing = kNoScale;
}

// The camera is in another map: one that the last one was merged into, one that it started after it
// was lost, or one that was split off the last one because vision does not tell its scale.
void InertialWatch::Enter(MapId map, double time, const MapSnapshot& snapshot) {
  const MapId left = std::exchange(map_, map);
  const auto in_map = [&](const Placement& placement) {
    return snapshot.MapOf(placement.anchor.keyframe) == map;
  };
  if (map < left && !placements_.empty() && in_map(placements_.back())) {
    ForgetMap();  // it was in the axes of the map that is gone
    Recall(snapshot);
    return;
  }
  std::erase_if(placements_, [&](const Placement& placement) { return !in_map(placement); });
  const double first = placements_.empty() ? time : placements_.front().time;
  if (report_.metric) {
    former_.reset();
    KeepWayFrom(left, first, snapshot);
  } else if (former_) {  // the map before was not joined yet
    former_ = former_->CarriedTo(first, snapshot, samples_);
  }
  if (learned_) calibration_ = *std::exchange(learned_, std::nullopt);
  ForgetMap();
  Recall(snapshot);
}

bool InertialWatch::TellsScale(MapId split) const {
  if (!may_scale_) return false;
  return split == map_ || !report_.metric ? former_.has_value() : reckoner_.known();
}

void InertialWatch::ForgetUnit(MapId split) {
  if (split != map_) return;
  known_scale_ = report_.scale_sigma = 0;
  report_.metric = false;
  report_.missing = kNoScale;
}

// Where the motion from the map `left` leads at `time`, by what was believed before.
void InertialWatch::KeepWayFrom(MapId left, double time, const MapSnapshot& map) {
  if (reckoner_.known()) past_.push_back(reckoner_);
  while (!past_.empty() &&
         (past_.back().time() >= time || map.MapOf(past_.back().reference()) != left))
    past_.pop_back();
  if (!past_.empty()) former_ = past_.back().CarriedTo(time, map, samples_);
}

// What is known of the map from before the camera came into it.
void InertialWatch::Recall(const MapSnapshot& map) {
  const MapWorld* world = map.WorldOf(map_);
  if (!world) return;
  if (world->meters) {
    known_scale_ = std::max(world->scale_sigma, kLeastScale);
    report_.metric = true;
    report_.missing.clear();
  }
  report_.scale_sigma = world->scale_sigma;
  if (world->KnowsDown()) report_.gravity = world->down;
  report_.gravity_sigma = world->down_sigma;
}

InertialWatch::Calibration InertialWatch::LearnedFrom(const InertialFit& fit) {
  Calibration learned;
  learned.model = fit.model;
  learned.model.rotation_known = learned.model.translation_known = true;
  learned.model.time_offset_known = true;
  InertialPriors& priors = learned.priors;
  priors.rotation_known = std::hypot(kRotationHolds, fit.rotation_sigma);
  priors.translation_known = std::hypot(kArmHolds, fit.translation_sigma);
  priors.time_offset_known = std::hypot(kClockHolds, fit.time_offset_sigma);
  priors.bias = fit.states.back().bias;
  priors.gyro_bias = std::hypot(kGyroHolds, fit.gyro_bias_sigma);
  priors.accel_bias = std::hypot(kAccelHolds, fit.accel_bias_sigma);
  return learned;
}

// The map before this one, if dead reckoning leads well enough from there to here.
std::optional<InertialWatch::Join> InertialWatch::JoinBy(const InertialFit& fit,
                                                         const MapSnapshot& map) {
  if (!former_ || !may_scale_ || !former_->known()) return std::nullopt;
  const auto there = former_->At(former_->time(), map, samples_);
  if (!there || there->time != fit.first.time) return std::nullopt;
  const std::optional<MapBridge> bridge = BridgeOf(*there, fit.first);
  const MapId older = map.MapOf(former_->reference());
  if (!(older < map_)) return std::nullopt;
  const double distance = fit.scale * DistanceIn(map);
  if (!bridge || bridge->sigma > kOfUse * distance || bridge->rotation > kOfUse)
    return std::nullopt;
  return Join{map_, older, bridge->T_a_b, former_->reference()};
}

std::optional<InertialWatch::Reckoned> InertialWatch::DeadReckoned(double time,
                                                                   const MapSnapshot& map) {
  if (!reckoner_.known() || !report_.metric || samples_.empty()) return std::nullopt;
  if (time + report_.model.time_offset > samples_.back().time + 0.05 || time < reckoner_.time())
    return std::nullopt;
  // From where the last call led to.
  const DeadReckoner& from = ahead_.known() && ahead_.time() <= time ? ahead_ : reckoner_;
  const auto there = from.CarriedTo(time, map, samples_);
  if (!there) return std::nullopt;
  ahead_ = *there;
  const auto belief = ahead_.At(time, map, samples_);
  const KeyFrame* reference = map.Find(ahead_.reference());
  if (!belief || !reference) return std::nullopt;
  const TimedPose pose = belief->Camera(samples_);
  const double sigma = std::sqrt(pose.covariance.diagonal().head<3>().maxCoeff());
  if (!(sigma < kOfUse * MedianDepth(map, *reference).value_or(1))) return std::nullopt;
  return Reckoned{pose, reference->map};
}

KeyFrameMotions::Motions InertialWatch::MissingMotions(const MapSnapshot& map) {
  if (!accepted_ || doubtful_ || !report_.metric || !report_.left_out.empty()) return {};
  return motions_.Missing(map, map_, *accepted_, samples_, doubted_until_);
}

double InertialWatch::MotionsHoldUntil() const {
  if (!report_.left_out.empty()) return kNever;
  return doubtful_ ? agreed_until_ : -kNever;
}

std::optional<MapWorld> InertialWatch::World() const {
  if (!given() || !report_.gravity || !map_.valid()) return std::nullopt;
  return MapWorld{map_, report_.metric, report_.scale_sigma, *report_.gravity,
                  report_.gravity_sigma};
}

}  // namespace alidade
