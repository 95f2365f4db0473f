// The stream of a run (docs/reference/stream.md) told to ROS: each frame as it was when it was
// done, and at the end what the run's files say.
#pragma once

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "alidade/ros/ros_log.h"
#include "alidade/run/folder/final_state.h"
#include "alidade/run/setup/stream_settings.h"
#include "alidade/stream/stream_scene.h"

namespace alidade {

class StreamToRos {
 public:
  // `log` must outlive it.
  StreamToRos(RosLog& log, const StreamFeedSettings& settings) : log_(log), settings_(settings) {}

  // The next message. Throws Error (input) as StreamScene::Take().
  void Take(std::string_view message);
  // When nothing follows. What `state` does not know is told as the stream has it, of the map with
  // the most frames.
  void End(FinalState state);

  const StreamScene& scene() const { return scene_; }

 private:
  // What is told as a whole now and then: the path, the points.
  struct Whole {
    double next = -std::numeric_limits<double>::infinity();  // not before that time, seconds
    uint64_t version = UINT64_MAX;                           // of the map it was told of
  };
  void TellEvents();
  void TellFrame();
  void TellPicture();
  void TellWholes();
  bool IsDue(const Whole& whole) const;
  void Told(Whole& whole, size_t bytes) const;
  Se3 Mounted(const Se3& T_world_camera) const;
  std::vector<RosPose> PathIn(MapId map) const;
  Cloud LandmarksIn(MapId map) const;
  Cloud ShapeIn(MapId map) const;
  void Mount(Cloud& cloud) const;
  MapId LargestMap() const;

  RosLog& log_;
  const StreamFeedSettings settings_;
  StreamScene scene_;
  MapId map_;  // that the camera was in last
  Whole path_, landmarks_, shape_;
  std::set<std::tuple<int, int, std::string>> events_;  // told: whole states repeat them
};

// Seconds after the last frame that the end is told at.
inline constexpr double kAfterTheLastFrame = 1e-3;

// What each stage took; `ms`: as in stream.fbs.
RosStatus MillisecondsStatus(const std::vector<float>& ms);

}  // namespace alidade
