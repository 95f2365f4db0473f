#include "alidade/run/recorder/stream_to_ros.h"

#include <algorithm>
#include <map>

#include "alidade/base/print.h"
#include "alidade/run/folder/result_folder.h"
#include "alidade/system/slam.h"

namespace alidade {
namespace {

std::string TwoDigits(double value) {
  char text[64];
  PrintTo(text, sizeof text, "%.2f", value);
  return text;
}

RosStatus StateOf(const SceneNow& now, MapId map, const std::string& source) {
  RosStatus status;
  status.name = "alidade: tracking";
  status.hardware_id = source;
  const auto state = static_cast<TrackState>(now.state);
  const std::string why = now.reason.empty() ? "" : ": " + now.reason;
  if (state == TrackState::kTracking) {
    status.message = "tracking";
  } else if (state == TrackState::kLost) {
    status.level = RosStatus::kError;
    status.message = "lost" + why;
  } else {
    status.level = RosStatus::kWarn;
    status.message = "initializing" + why;
  }
  status.values = {{"frame", std::to_string(now.number)},
                   {"matches", std::to_string(now.matches)},
                   {"keyframes", std::to_string(now.keyframes)},
                   {"landmarks", std::to_string(now.landmarks)},
                   {"maps", std::to_string(now.maps)}};
  if (map.valid()) status.values.push_back({"map", std::to_string(map.value)});
  return status;
}

}  // namespace

RosStatus MillisecondsStatus(const std::vector<float>& ms) {
  RosStatus status;
  status.name = "alidade: milliseconds";
  for (size_t i = 0; i < std::min(ms.size(), kResultStages.size()); ++i) {
    if (ms[i] >= 0) status.values.push_back({kResultStages[i], TwoDigits(ms[i])});
  }
  status.message = status.values.empty() ? "unknown" : status.values.front().second + " ms";
  return status;
}

void StreamToRos::Take(std::string_view message) {
  const int frames = scene_.frames;
  scene_.Take(message);
  log_.SetRectification(scene_.R_camera_rectified);
  TellEvents();
  if (scene_.frames > frames) TellFrame();
}

void StreamToRos::TellEvents() {
  for (const SceneEvent& event : scene_.events) {
    if (!events_.insert({event.kind, event.number, event.text}).second) continue;
    log_.Event(event.time, event.bad ? RosLogLevel::kWarn : RosLogLevel::kInfo, event.text);
  }
}

void StreamToRos::TellFrame() {
  const SceneNow& now = scene_.now;
  if (now.map.valid()) map_ = now.map;
  TellPicture();
  std::optional<Se3> pose;
  if (now.T_world_camera) pose = Mounted(*now.T_world_camera);
  log_.Pose(now.time, pose);
  log_.Diagnostics(now.time, {StateOf(now, map_, scene_.source), MillisecondsStatus(now.ms)});
  TellWholes();
}

// With the camera of the sent image, which may be smaller than the tracked one.
void StreamToRos::TellPicture() {
  const SceneNow& now = scene_.now;
  if (now.picture.empty() || scene_.camera.width <= 0 || scene_.camera.height <= 0) return;
  Camera camera = scene_.camera;
  const double x = static_cast<double>(now.picture_width) / camera.width;
  const double y = static_cast<double>(now.picture_height) / camera.height;
  if (x != 1 || y != 1) {
    camera.fx *= x;
    camera.fy *= y;
    camera.cx = (camera.cx + 0.5) * x - 0.5;  // the image borders coincide
    camera.cy = (camera.cy + 0.5) * y - 0.5;
    camera.width = now.picture_width;
    camera.height = now.picture_height;
  }
  const bool jpeg = now.picture_type == "image/jpeg";
  log_.Picture(now.time, jpeg ? "jpeg" : now.picture_type, now.picture);
  log_.Calibration(now.time, camera);
}

void StreamToRos::TellWholes() {
  if (!map_.valid()) return;
  const double time = scene_.now.time;
  if (time >= path_.next) Told(path_, log_.Path(time, PathIn(map_)));
  if (IsDue(landmarks_)) Told(landmarks_, log_.Landmarks(time, LandmarksIn(map_)));
  if (!IsDue(shape_)) return;
  const Cloud shape = ShapeIn(map_);
  if (!shape.points.empty()) Told(shape_, log_.Shape(time, shape));
}

bool StreamToRos::IsDue(const Whole& whole) const {
  return scene_.now.time >= whole.next && scene_.version != whole.version;
}

void StreamToRos::Told(Whole& whole, size_t bytes) const {
  whole.next = scene_.now.time +
               std::max(settings_.mcap_seconds, static_cast<double>(bytes) / settings_.mcap_rate);
  whole.version = scene_.version;
}

// From the world of the rectified camera to that of the camera as mounted, which trajectories use.
Se3 StreamToRos::Mounted(const Se3& T_world_camera) const {
  const Se3 turn{scene_.R_camera_rectified, Eigen::Vector3d::Zero()};
  return turn * T_world_camera * turn.Inverse();
}

void StreamToRos::Mount(Cloud& cloud) const {
  if (scene_.R_camera_rectified.isIdentity(0)) return;
  for (Eigen::Vector3f& p : cloud.points)
    p = (scene_.R_camera_rectified * p.cast<double>()).cast<float>();
}

std::vector<RosPose> StreamToRos::PathIn(MapId map) const {
  std::vector<RosPose> path;
  for (const SceneFrame& frame : scene_.path) {
    const auto reference = scene_.keyframes.find(frame.reference);
    if (reference == scene_.keyframes.end() || reference->second.map != map) continue;
    path.push_back({RosTime::FromSeconds(frame.time), Mounted(scene_.PoseOf(frame))});
  }
  return path;
}

Cloud StreamToRos::LandmarksIn(MapId map) const {
  Cloud cloud;
  for (const auto& [id, landmark] : scene_.landmarks) {
    const auto keyframe = scene_.keyframes.find(landmark.keyframe);
    if (keyframe == scene_.keyframes.end() || keyframe->second.map != map) continue;
    cloud.points.push_back(scene_.PointOf(landmark).cast<float>());
  }
  Mount(cloud);
  return cloud;
}

Cloud StreamToRos::ShapeIn(MapId map) const {
  Cloud cloud;
  for (const auto& [id, keyframe] : scene_.keyframes) {
    if (keyframe.map == map) scene_.AddDepth(keyframe, cloud);
  }
  Mount(cloud);
  return cloud;
}

MapId StreamToRos::LargestMap() const {
  std::map<MapId, int> frames;
  for (const SceneFrame& frame : scene_.path) {
    const auto reference = scene_.keyframes.find(frame.reference);
    if (reference != scene_.keyframes.end()) ++frames[reference->second.map];
  }
  MapId largest = map_;
  for (const auto& [map, count] : frames) {
    if (count > frames[largest]) largest = map;
  }
  return largest;
}

void StreamToRos::End(FinalState state) {
  const MapId map = LargestMap();
  std::vector<RosPose> path;
  for (const StampedPose& pose : state.trajectory)
    path.push_back({RosTime::FromSeconds(pose.time), pose.T_world_camera});
  if (path.empty()) path = PathIn(map);
  if (!state.landmarks) state.landmarks = LandmarksIn(map);
  if (!state.shape) state.shape = ShapeIn(map);
  // tf2 ignores further transforms with the same time.
  const double time = scene_.now.time + kAfterTheLastFrame;
  if (!path.empty()) {
    log_.Transforms(time, path.back().T_frame_body);
    log_.Path(time, path);
  }
  if (scene_.frames > 0) log_.Landmarks(time, *state.landmarks);
  if (!state.shape->points.empty()) log_.Shape(time, *state.shape);
}

}  // namespace alidade
