// The map of a short walk through a rendered room, and pictures of the same room by other cameras.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/calibration.h"
#include "alidade/synth/recording.h"
#include "alidade/system/slam.h"
#include "support/aligned_poses.h"

namespace alidade {

struct RoomMap {
  SavedMap saved;
  Se3 T_map_room;     // of the map's world
  double meters = 1;  // of one unit of the map
};

// `frames` of the scene by a camera of 320 x 240 pixels; about 15 ms each.
inline RoomMap MapOfRoom(Sensor sensor, int frames, const std::string& name = "room",
                         uint64_t seed = 1) {
  SynthSettings scene;
  scene.scene = name;
  scene.seed = seed;
  scene.width = 320;
  scene.height = 240;
  scene.frames = frames;
  scene.stereo = sensor == Sensor::kStereo;
  const SynthRecording room(scene);
  SlamSettings settings;
  settings.sensor = sensor;
  settings.semidense.enabled = false;
  Slam slam(room.camera(), settings);
  for (int i = 0; i < frames; ++i) {
    const RenderedFrame frame = room.Render(i);
    slam.Track({frame.time, frame.image, frame.right, frame.depth});
  }
  RoomMap made;
  Se3 last;  // of the last frame with a pose
  int first_index = -1, last_index = -1;
  for (const FramePose& pose : slam.Finish()) {
    if (!pose.tracked) continue;
    if (first_index < 0) {
      first_index = pose.index;
      made.T_map_room = pose.T_world_camera * room.Pose(pose.index).Inverse();
    }
    last_index = pose.index;
    last = pose.T_world_camera;
  }
  const Eigen::Vector3d centre = made.T_map_room * room.Pose(first_index).t;
  made.meters =
      (room.Pose(last_index).t - room.Pose(first_index).t).norm() / (last.t - centre).norm();
  if (sensor != Sensor::kMono) made.meters = 1;
  made.saved = slam.Saved();
  return made;
}

// The alignment of the keyframes with their true poses, in which a radian counts as 2 m.
inline Sim3 AlignmentInRoom(const RoomMap& map, const SynthRecording& room) {
  std::vector<Se3> estimated, real;
  for (const KeyFrameId id : map.saved.map.KeyFrames()) {
    const KeyFrame& keyframe = *map.saved.map.Find(id);
    estimated.push_back(keyframe.T_camera_world.Inverse());
    real.push_back(room.Pose(keyframe.frame->number));
  }
  return AlignmentOf(estimated, real, 2 / map.meters, map.meters != 1);
}

// Distance in meters between a pose in the map and the true one.
inline double ErrorInRoom(const RoomMap& map, const Se3& T_map_camera, const Se3& T_room_camera,
                          const Se3& T_room_first) {
  const Eigen::Vector3d first = map.T_map_room * T_room_first.t;
  const Eigen::Vector3d way = map.T_map_room.R * (T_room_camera.t - T_room_first.t);
  return ((T_map_camera.t - first) * map.meters - way).norm();
}

inline Calibration LensOf(const SynthRecording& recording) {
  Calibration calibration;
  calibration.left = recording.lens();
  return calibration;
}

}  // namespace alidade
