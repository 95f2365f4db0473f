// Collects the readings of an inertial sensor and the poses of the camera, and asks what they tell
// together: meters, gravity, biases, and where the sensor sits. Used by the driving thread; the fit
// itself may run in another.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "alidade/inertial/imu_stream.h"
#include "alidade/inertial/inertial_fit.h"
#include "alidade/inertial/rotation_match.h"
#include "alidade/io/frame_source.h"
#include "alidade/map/anchor.h"
#include "alidade/system/types.h"

namespace alidade {

// Poses and readings of one stretch of time, to be fitted in any thread.
struct InertialQuestion {
  std::vector<TimedPose> poses;
  std::vector<ImuSample> samples;
  ImuModel model;
  InertialPriors priors;
  std::optional<InertialFit> start;
  MapId map;
  KeyFrameId reference;  // of the newest pose
  double scale = 1;      // KeyFrame::scale of it
};

struct InertialAnswer {
  InertialFit fit;
  RotationMatch rotation;
  MapId map;
  KeyFrameId reference;
  double scale = 1;
};

InertialAnswer AnswerOf(const InertialQuestion& question);

class InertialWatch {
 public:
  // `may_scale`: maps may be changed; false when localizing in them.
  InertialWatch(Sensor sensor, bool may_scale) : sensor_(sensor), may_scale_(may_scale) {}

  void SetImu(const ImuModel& model);
  bool given() const { return report_.given; }
  // Readings since the last call, cleaned by an ImuStream.
  void Take(std::span<const ImuSample> samples);
  // The frame of `time` (seconds, on the clock of the images) has a pose.
  void Placed(double time, const Anchor& anchor, MapId map, const Matrix6d& covariance);
  void Cut();  // the next readings and poses do not continue the last ones
  // Poses relative to culled keyframes become relative to live ones.
  void Reanchor(const MapSnapshot& map);

  // What to fit next; nullopt: nothing new, or the last answer is still awaited.
  std::optional<InertialQuestion> Ask(const MapSnapshot& map);
  // Any thread.
  void Answer(InertialAnswer answer);
  // Uses an answer that has come. Returns the map whose lengths are to grow to be meters, and
  // by which factor; nullopt: none.
  struct Growth {
    MapId map;
    double factor = 1;
  };
  std::optional<Growth> UseAnswer(const MapSnapshot& map);

  // Rotation of the camera between two times of images by the gyroscope alone: R_to_from. nullopt
  // if its rotation to the camera is not known, or the readings do not cover the time.
  std::optional<Eigen::Matrix3d> TurnBetween(double from, double to) const;

  const InertialReport& report() const { return report_; }

 private:
  struct Placement {
    double time = 0;
    Anchor anchor;
    Matrix6d covariance = Matrix6d::Zero();
  };
  static constexpr double kNever = -1e18;  // seconds
  void ForgetMap();                        // what was found of a map that the camera has left
  std::vector<TimedPose> PosesIn(const MapSnapshot& map) const;
  std::span<const ImuSample> SamplesFrom(double time) const;
  bool Accepts(const InertialFit& fit) const;
  void Judge(const InertialAnswer& answer);

  Sensor sensor_;
  bool may_scale_;
  ImuModel given_model_;  // as given
  InertialReport report_;
  ImuStream stream_;
  std::vector<ImuSample> samples_;
  std::deque<Placement> placements_;
  MapId map_;                       // that placements_ are in
  std::optional<InertialFit> fit_;  // the last one that was solved, in map_
  double asked_at_ = kNever;        // time of the newest pose of the last question
  bool awaiting_ = false;
  int agreements_ = 0;      // answers in which the rotations agree
  int contradictions_ = 0;  // consecutive answers in which rotations disagree
  std::mutex mutex_;
  std::optional<InertialAnswer> answer_;  // under mutex_
};

}  // namespace alidade
