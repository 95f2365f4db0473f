// Converts the stream of a run (docs/reference/stream.md) to ROS messages: each frame as it was
// processed, and at the end the final results.
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
  // `log` must outlive this object.
  StreamToRos(RosLog& log, const StreamFeedSettings& settings) : log_(log), settings_(settings) {
    scene_.most_frames = static_cast<size_t>(settings.stream.path_frames);
  }

  // The next message. Throws Error (input) as StreamScene::Take().
  void Take(std::string_view message);
  // After the last message. What `state` does not contain is taken from the stream, for the map
  // with the most frames.
  void End(FinalState state);

  const StreamScene& scene() const { return scene_; }

 private:
  // Messages that repeat a whole state at intervals: the path, the points.
  struct Whole {
    // earliest time of the next message, seconds
    double next = -std::numeric_limits<double>::infinity();
    uint64_t version = UINT64_MAX;  // version of the map that was last written
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
  MapId map_;  // the last map of the camera
  Whole path_, landmarks_, shape_;
  // events already written, which complete states repeat
  std::set<std::tuple<int, int, std::string>> events_;
};

// Time of the final messages after the last frame, seconds.
inline constexpr double kAfterTheLastFrame = 1e-3;

// Processing times of the stages; `ms`: as in stream.fbs.
RosStatus MillisecondsStatus(const std::vector<float>& ms);

}  // namespace alidade
