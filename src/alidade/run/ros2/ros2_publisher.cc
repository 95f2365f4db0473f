#include "alidade/run/ros2/ros2_publisher.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/ros/live/domain.h"
#include "alidade/run/results/run_results.h"

namespace alidade {
namespace {

constexpr char kNodeName[] = "alidade";
constexpr char kCameraFrame[] = "camera_optical";

// Of what StreamToRos says, what is not told otherwise or known to whoever sends the images.
bool IsOfMap(std::string_view topic) {
  return topic == "/alidade/path" || topic == "/alidade/landmarks" ||
         topic == "/alidade/semidense" || topic == "/alidade/events" || topic == "/diagnostics";
}

// The whole path is sent again and again, to displays.
StreamFeedSettings WithShortPath(StreamFeedSettings settings) {
  constexpr int kMostFrames = 3000;
  settings.stream.path_frames = std::min(settings.stream.path_frames, kMostFrames);
  return settings;
}

// Of an error in the body's frame (PoseQuality), along and about the axes of another frame.
Matrix6d AlongAxesOf(const Se3& T_frame_body, const Matrix6d& covariance) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T_frame_body.R;
  return turn * covariance * turn.transpose();
}

}  // namespace

Ros2Publisher::Ros2Publisher(const Ros2Options& options, StreamHub& hub,
                             const StreamFeedSettings& settings)
    : names_(options.names),
      mount_(options.mount),
      with_grid_(options.grid),
      hub_(hub),
      node_(JoinDomain(DomainFromEnvironment(), kNodeName)),
      log_([this](const char* topic, RosType type, double, const std::string& message) {
        if (!IsOfMap(topic)) return;
        Publish(topic, type, DdsQuality::kReliable, message);
      }),
      map_(log_, WithShortPath(settings)) {}

Ros2Publisher::~Ros2Publisher() {
  if (taker_ >= 0) hub_.Leave(taker_);
}

void Ros2Publisher::Publish(const std::string& topic, RosType type, DdsQuality quality,
                            const std::string& message) {
  int publication = -1;
  {
    const std::lock_guard<std::mutex> lock(publications_mutex_);
    const auto known = publications_.find(topic);
    if (known != publications_.end()) {
      publication = known->second;
    } else {
      std::string problem;
      publication = node_->Advertise(topic, ShortNameOf(type), quality, &problem);
      if (publication < 0) LogWarning(topic + " is not published: " + problem);
      publications_[topic] = publication;
    }
  }
  if (publication >= 0) node_->Publish(publication, message);
}

void Ros2Publisher::Begin(const WatchedRun& run, const std::string& folder) {
  (void)folder;
  run_.emplace(run);
  const SourceInfo& source = run.setup.source;
  mount_told_ = !mount_ && source.T_base_camera;
  T_base_camera_ = mount_ ? *mount_ : source.T_base_camera.value_or(CameraAtBase());
  if (names_.camera.empty())
    names_.camera = source.frame_id.empty() ? std::string(kCameraFrame) : source.frame_id;
  frames_.emplace(T_base_camera_);
  taker_ =
      hub_.Join([this](const std::shared_ptr<const std::string>& message) { map_.Take(*message); });
  if (with_grid_)
    grid_ =
        std::make_unique<LiveGrid>(LiveGridSettings(), *run_, frames_->T_map_world(),
                                   [this](const OccupancyPicture& picture, const Se3& T_map_floor) {
                                     PublishGrid(picture, T_map_floor);
                                   });
  commands_ = std::make_unique<Ros2Commands>(*node_, [this] { Save(); });
}

void Ros2Publisher::Tell(RosLogLevel level, const std::string& text) {
  if (level != RosLogLevel::kInfo) LogWarning(text);
  log_.Event(now_, level, text);
}

void Ros2Publisher::PublishGrid(const OccupancyPicture& picture, const Se3& T_map_floor) {
  RosGrid grid;
  grid.cell = picture.cell;
  grid.width = static_cast<uint32_t>(picture.width);
  grid.height = static_cast<uint32_t>(picture.height);
  grid.T_frame_corner =
      T_map_floor * Se3{Eigen::Matrix3d::Identity(), Eigen::Vector3d(picture.x, picture.y, 0)};
  grid.cells = picture.cells;
  Publish("/map", RosType::kGrid, DdsQuality::kLatched,
          EncodeGrid({RosTime::FromSeconds(now_), names_.map}, grid));
}

// Beside the result folder, which appears at the end.
void Ros2Publisher::Save() {
  const std::string file = run_->place + ".alidade";
  try {
    AtomicWriteFile(file, run_->slam.SaveMap());
  } catch (const Error& error) {
    Tell(RosLogLevel::kWarn, std::string("the map was not saved: ") + error.what());
    return;
  }
  Tell(RosLogLevel::kInfo, "the map was saved to " + file);
}

RunRequest Ros2Publisher::Asked() {
  const RunRequest request = commands_->Take();
  const bool localize = run_->setup.settings.slam.localize;
  if (request.forget)
    Tell(RosLogLevel::kInfo, localize ? "looks for its place in the map anew"
                                      : "all maps were removed; a new one begins");
  if (request.mapping && localize)
    Tell(RosLogLevel::kWarn, "the run was started with --localize: its map stays as it is");
  else if (request.mapping)
    Tell(RosLogLevel::kInfo, *request.mapping ? "the map grows again" : "the map stays as it is");
  return request;
}

void Ros2Publisher::PublishMount(double time) {
  const RosTime stamp = RosTime::FromSeconds(time);
  std::vector<RosTransform> fixed = {{stamp, names_.map, kRosWorld, frames_->T_map_world()}};
  if (!mount_told_) fixed.push_back({stamp, names_.base, names_.camera, T_base_camera_});
  Publish("/tf_static", RosType::kTransforms, DdsQuality::kLatched, EncodeTransforms(fixed));
}

void Ros2Publisher::Follow(const TrackResult& result) {
  const Slam& slam = run_->slam;
  const Eigen::Matrix3d& turn = run_->setup.source.R_camera_rectified;
  const int index = slam.frames() - 1;
  const std::vector<FramePose> poses = slam.Trajectory(last_.value_or(index));
  std::optional<Se3> before;
  Se3 now = result.T_world_camera;
  if (!poses.empty() && poses.back().index == index && poses.back().tracked) {
    now = poses.back().T_world_camera;
    const FramePose& first = poses.front();
    if (last_ && first.index == *last_ && first.tracked && first.map == poses.back().map)
      before = Mounted(first.T_world_camera, turn);
  }
  if (result.T_last_camera) before = Mounted(now * result.T_last_camera->Inverse(), turn);
  frames_->Add(Mounted(now, turn), before);
  last_ = index;
}

void Ros2Publisher::PublishOdometry(double time, const TrackResult& result) {
  const RosTime stamp = RosTime::FromSeconds(time);
  const RobotFrames& frames = *frames_;
  Publish("/tf", RosType::kTransforms, DdsQuality::kReliable,
          EncodeTransforms({{stamp, names_.map, names_.odom, frames.T_map_odom()},
                            {stamp, names_.odom, names_.base, frames.T_odom_base()}}));
  const Eigen::Matrix3d& turn = run_->setup.source.R_camera_rectified;
  const Matrix6d of_base =
      Carried(T_base_camera_ * Se3{turn, Eigen::Vector3d::Zero()}, result.quality.covariance);
  Publish("/alidade/pose", RosType::kPoseWithCovariance, DdsQuality::kReliable,
          EncodeUncertainPose({stamp, names_.map},
                              {frames.T_map_base(), AlongAxesOf(frames.T_map_base(), of_base)}));
  RosOdometry odometry;
  odometry.child_frame_id = names_.base;
  odometry.pose = {frames.T_odom_base(), AlongAxesOf(frames.T_odom_base(), of_base)};
  if (const double dt = time - last_time_; dt > 0) {
    const Vector6d twist = frames.step().Log() / dt;
    odometry.velocity = twist.head<3>();
    odometry.rate = twist.tail<3>();
    // Of two poses with independent errors.
    odometry.twist_covariance = 2 * of_base / (dt * dt);
  }
  Publish("/alidade/odometry", RosType::kOdometry, DdsQuality::kReliable,
          EncodeOdometry({stamp, names_.odom}, odometry));
  last_time_ = time;
}

void Ros2Publisher::Frame(const SourceFrame& frame, const TrackResult& result) {
  for (const std::string& sentence : node_->News()) LogWarning(sentence);
  now_ = frame.time;
  if (!std::exchange(mount_published_, true)) PublishMount(frame.time);
  if (grid_) grid_->Add(frame, result);
  if (result.state != TrackState::kTracking) return;
  Follow(result);
  PublishOdometry(frame.time, result);
}

}  // namespace alidade
