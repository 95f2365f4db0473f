// Collects the readings of an inertial sensor and the poses of the camera, and asks what they tell
// together: meters, gravity, biases, and where the sensor sits. Used by the driving thread; the fit
// itself may run in another.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alidade/inertial/imu_stream.h"
#include "alidade/inertial/inertial_fit.h"
#include "alidade/inertial/rotation_match.h"
#include "alidade/io/frame_source.h"
#include "alidade/map/anchor.h"
#include "alidade/map/map_world.h"
#include "alidade/system/inertial/dead_reckoner.h"
#include "alidade/system/inertial/keyframe_motions.h"
#include "alidade/system/types.h"

namespace alidade {

// Poses and readings of one stretch of time, to be fitted in any thread.
struct InertialQuestion {
  std::vector<TimedPose> poses;
  std::vector<ImuSample> samples;
  ImuModel model;
  InertialPriors priors;
  std::optional<InertialFit> start;
  // The sensor as in the last fit that was accepted; nullopt: none was.
  std::optional<std::pair<ImuModel, ImuBias>> accepted;
  MapId map;
  KeyFrameId reference;   // of the newest pose
  Se3 T_reference_world;  // pose and KeyFrame::scale of that keyframe when it was asked
  double scale = 1;
};

struct InertialAnswer {
  InertialFit fit;
  RotationMatch rotation;
  RotationMatch newest;  // CompareRotations() of the newest readings, by what was accepted
  MapId map;
  KeyFrameId reference;
  Se3 T_reference_world;
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
  void Placed(double time, const Anchor& anchor, const Matrix6d& covariance,
              const MapSnapshot& map);
  // The newest readings, at least those of the last 5 s.
  std::span<const ImuSample> samples() const { return samples_; }
  void Cut();  // the next readings and poses do not continue the last ones
  // Poses relative to culled keyframes become relative to live ones.
  void Reanchor(const MapSnapshot& map);

  // What to fit next; nullopt: nothing new, or the last answer is still awaited.
  std::optional<InertialQuestion> Ask(const MapSnapshot& map);
  // Any thread.
  void Answer(InertialAnswer answer);
  // Uses an answer that has come, and tells what is to be changed in the map: the lengths of a map
  // grow to be meters by a factor, or a map is joined to the one before it.
  struct Growth {
    MapId map;
    double factor = 1;
  };
  struct Join {
    MapId younger, older;
    Sim3 T_older_younger;
    KeyFrameId anchor;  // keyframe of `older` that the first one of `younger` follows
  };
  struct Changes {
    std::optional<Growth> growth;
    std::optional<Join> join;
  };
  Changes UseAnswer(const MapSnapshot& map);
  // The pose of the camera at `time` (later than the last pose) by the readings since, with its
  // covariance, and the map it is in; nullopt: it is not known well enough to be of use.
  struct Reckoned {
    TimedPose pose;
    MapId map;
  };
  std::optional<Reckoned> DeadReckoned(double time, const MapSnapshot& map);

  // Rotation of the camera between two times of images by the gyroscope alone: R_to_from. nullopt
  // if its rotation to the camera is not known, or the readings do not cover the time.
  std::optional<Eigen::Matrix3d> TurnBetween(double from, double to) const;

  // Motions of keyframes that have none yet.
  KeyFrameMotions::Motions MissingMotions(const MapSnapshot& map);
  // Motions of later keyframes (time of their image, seconds) are of no use; above all times: none.
  double MotionsHoldUntil() const;

  // Whether a map is of use that was split off the map in meters because vision does not tell its
  // scale: the readings will tell it, and it is joined to that one then.
  bool TellsScale(MapId split) const;
  void ForgetUnit(MapId split);  // nothing is known of its lengths

  const InertialReport& report() const { return report_; }
  // What it tells of the world of the map that the camera is in; nullopt: nothing yet.
  std::optional<MapWorld> World() const;

 private:
  struct Placement {
    double time = 0;
    Anchor anchor;
    Matrix6d covariance = Matrix6d::Zero();
  };
  // Priors of the fits in one map: what was given, or what the maps before told.
  struct Calibration {
    ImuModel model;
    InertialPriors priors;
  };
  static constexpr double kNever = -1e18;  // seconds
  void ForgetMap();                        // what was found of a map that the camera has left
  std::vector<TimedPose> PosesIn(const MapSnapshot& map) const;
  TimedPose PoseIn(const MapSnapshot& map, const Placement& placement, double distance) const;
  double DistanceIn(const MapSnapshot& map) const;
  void FollowPoses(const MapSnapshot& map);
  void Enter(MapId map, double time, const MapSnapshot& snapshot);
  void KeepWayFrom(MapId left, double time, const MapSnapshot& map);
  void Recall(const MapSnapshot& map);
  static Calibration LearnedFrom(const InertialFit& fit);
  std::optional<Join> JoinBy(const InertialFit& fit, const MapSnapshot& map);
  std::span<const ImuSample> SamplesFrom(double time) const;
  bool Accepts(const InertialAnswer& answer) const;
  void Trust(const InertialAnswer& answer);
  void Judge(const InertialAnswer& answer);

  Sensor sensor_;
  bool may_scale_;
  InertialReport report_;
  ImuStream stream_;
  std::vector<ImuSample> samples_;
  std::deque<Placement> placements_;
  MapId map_;                      // that placements_ are in
  double known_scale_ = 0;         // sigma of its scale when the camera entered it; 0: unknown
  DeadReckoner reckoner_;          // in map_, once its lengths are meters
  DeadReckoner ahead_;             // reckoner_ carried to the last time that was asked for
  std::deque<DeadReckoner> past_;  // reckoner_ at the poses of the last seconds
  // Where dead reckoning from the map before map_ leads at the first pose in map_.
  std::optional<DeadReckoner> former_;
  Calibration calibration_;              // priors of the fits in map_
  std::optional<Calibration> learned_;   // in map_, for the next one
  std::optional<InertialFit> fit_;       // the last one that was solved, in map_
  double asked_at_ = kNever;             // time of the newest pose of the last question
  std::optional<InertialFit> accepted_;  // the last one that was accepted, in map_
  KeyFrameMotions motions_;
  bool doubtful_ = false;  // a fit was accepted in map_, and the last one contradicts the readings
  double agreed_until_ = kNever;   // time of the newest pose of the last fit that agreed
  double doubted_until_ = kNever;  // time of an image before which there was doubt
  bool awaiting_ = false;
  int agreements_ = 0;      // answers in which the rotations agree
  int contradictions_ = 0;  // consecutive answers in which rotations disagree
  std::mutex mutex_;
  std::optional<InertialAnswer> answer_;  // under mutex_
};

}  // namespace alidade
