// Tells how the camera is oriented with respect to gravity and to where it looked at the start, in
// every frame, also while there is no map: from the readings of an inertial sensor, and rotations
// between images or to the map. Used by the driving thread.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "alidade/inertial/attitude.h"
#include "alidade/map/map_world.h"
#include "alidade/system/types.h"
#include "alidade/tracking/turn_views.h"

namespace alidade {

class OrientationWatch {
 public:
  // `match_scale`: features relative to 1000 (MonoStartSettings).
  explicit OrientationWatch(double match_scale) : views_(match_scale) {}

  void SetImu(const ImuModel& model);
  // The next frame does not continue the last one: the orientation is told from a new start.
  void Restart();

  // A frame that was tracked in a map.
  struct MapPose {
    MapId map;
    Eigen::Matrix3d R_map_camera;
    Eigen::Matrix3d covariance;     // of its error in the camera's axes, rad²; zero: unknown
    std::optional<MapWorld> world;  // what is known of gravity in that map
  };
  // What a frame tells; frames in order of time. `time`: seconds, as given. `samples`: the readings
  // of at least the last 5 s. nullopt: not known, since the rotation of the sensor to the camera is
  // not known yet, or the readings are missing.
  std::optional<CameraOrientation> See(const Frame& frame, const Camera& camera, double time,
                                       std::span<const ImuSample> samples,
                                       const std::optional<MapPose>& pose);

 private:
  struct View {
    int id;
    Eigen::Matrix3d R_camera_view;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };
  // What one frame adds to the filter, once readings cover it.
  struct Event {
    double time = 0;
    Eigen::Matrix3d R_start_camera = Eigen::Matrix3d::Identity();
    bool known = false;  // R_start_camera follows from the image
    std::optional<TurnViews::Seen> seen;
    std::vector<int> dropped;
    std::vector<View> added;
    double spot_sigma = 0;  // of the camera's position at the spot, meters; 0: unknown
    bool new_spot = false;
  };
  struct Learned {
    ImuModel model;
    AttitudePriors priors;
  };
  Event EventOf(const Frame& frame, const Camera& camera, double time,
                std::span<const ImuSample> samples, const std::optional<MapPose>& pose);
  std::optional<Eigen::Matrix3d> TurnSince(double time, std::span<const ImuSample> samples) const;
  void FindSensor(std::span<const ImuSample> samples);
  void Begin(std::span<const ImuSample> samples);
  static bool Use(const Event& event, std::span<const ImuSample> samples, AttitudeFilter& filter);
  void UseCovered(std::span<const ImuSample> samples);
  static CameraOrientation Told(const AttitudeFilter& filter, const std::optional<MapPose>& pose);

  ImuModel given_;
  std::optional<Learned> sensor_;  // what is known of it, once that is enough to begin
  TurnViews views_;
  std::vector<double> lens_;   // of the camera that views_ are of
  std::deque<Event> waiting_;  // for the sensor to be known, or for readings
  std::optional<AttitudeFilter> filter_;
  std::optional<Event> last_;  // the last frame
  MapId map_;                  // that a frame was tracked in last; invalid: none
  Eigen::Matrix3d R_start_map_ = Eigen::Matrix3d::Identity();
  double spot_since_ = 0;  // seconds
  int refused_ = 0;        // poses in a row that contradict the gyroscope
  int until_match_ = 0;    // frames until rotations are compared again
};

}  // namespace alidade
