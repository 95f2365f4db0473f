// Publishes a run on topics of ROS 2 (docs/guides/ros2.md lists them).
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "alidade/io/dds/dds_module.h"
#include "alidade/ros/robot_frames.h"
#include "alidade/ros/ros_log.h"
#include "alidade/run/play/watcher.h"
#include "alidade/run/recorder/stream_to_ros.h"
#include "alidade/run/ros2/live_grid.h"
#include "alidade/run/ros2/ros2_commands.h"
#include "alidade/stream/stream_hub.h"

namespace alidade {

struct Ros2Names {
  std::string map = "map", odom = "odom", base = "base_link";
  // Of the camera; empty: that of the images' messages, or "camera_optical".
  std::string camera;
};

struct Ros2Options {
  Ros2Names names;
  // T_base_camera; nullopt: that of /tf_static (SourceInfo::T_base_camera), or CameraAtBase().
  std::optional<Se3> mount;
  bool grid = false;  // publishes /map
};

class Ros2Publisher : public RunWatcher {
 public:
  // `hub`: the run as a stream, from which the map is told; must outlive this
  // object. Throws Error (input) if the domain of the environment cannot be joined.
  Ros2Publisher(const Ros2Options& options, StreamHub& hub, const StreamFeedSettings& settings);
  ~Ros2Publisher() override;
  Ros2Publisher(const Ros2Publisher&) = delete;
  Ros2Publisher& operator=(const Ros2Publisher&) = delete;

  void Begin(const WatchedRun& run, const std::string& folder) override;
  RunRequest Asked() override;
  void Frame(const SourceFrame& frame, const TrackResult& result) override;

 private:
  void Publish(const std::string& topic, RosType type, DdsQuality quality,
               const std::string& message);
  // A sentence for users on the topic of events; warnings are on the terminal, too.
  void Tell(RosLogLevel level, const std::string& text);
  void Save();
  void PublishGrid(const OccupancyPicture& picture, const Se3& T_map_floor);
  void PublishMount(double time);
  // Poses by the map as it is now; see RobotFrames::Add().
  void Follow(const TrackResult& result);
  void PublishOdometry(double time, const TrackResult& result);

  Ros2Names names_;
  const std::optional<Se3> mount_;
  const bool with_grid_;
  StreamHub& hub_;
  std::unique_ptr<DdsNode> node_;
  std::mutex publications_mutex_;
  std::map<std::string, int> publications_;  // by topic; guarded by publications_mutex_
  RosLog log_;
  StreamToRos map_;  // used by the stream's thread only
  int taker_ = -1;
  std::optional<WatchedRun> run_;
  Se3 T_base_camera_;
  std::optional<RobotFrames> frames_;
  bool mount_told_ = false;  // /tf_static has the camera already
  bool mount_published_ = false;
  std::optional<int> last_;     // FramePose::index of the last frame with a pose
  double last_time_ = 0;        // its time, seconds
  std::atomic<double> now_{0};  // time of the last frame, seconds
  // Last, because their threads use the other members.
  std::unique_ptr<Ros2Commands> commands_;
  std::unique_ptr<LiveGrid> grid_;
};

}  // namespace alidade
