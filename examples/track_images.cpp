// Tracks a recording through the library: prints the pose of each frame, saves the map.
//   track_images RECORDING MAP.alidade
#include <alidade/slam.h>

#include <cstdio>

#include "alidade/io/files/file.h"
#include "alidade/io/files/open_source.h"

int main(int count, char** arguments) try {
  if (count != 3) {
    std::fprintf(stderr, "usage: track_images RECORDING MAP.alidade\n");
    return 2;
  }
  // A folder (TUM, EuRoC, KITTI, images), a video or a ROS recording; images are rectified if
  // needed.
  const auto source = alidade::OpenSource(arguments[1]);
  const alidade::SourceInfo& info = source->Info();

  alidade::SlamSettings settings;
  settings.sensor = info.sensor;  // mono, stereo or rgbd
  if (info.camera_guessed && info.sensor == alidade::Sensor::kMono)
    settings.EnableSelfCalibration();  // no calibration: estimate it on the way
  alidade::Slam slam(info.camera, settings);

  while (const auto frame = source->Next()) {
    if (!frame->problem.empty()) continue;  // this image cannot be read
    const alidade::TrackResult result = slam.Track(
        {.time = frame->time, .image = frame->image, .right = frame->right, .depth = frame->depth});
    if (result.state == alidade::TrackState::kTracking) {
      const Eigen::Vector3d& p = result.T_world_camera.t;  // position of the camera
      std::printf("%s %.4f %.4f %.4f\n", frame->stamp.c_str(), p.x(), p.y(), p.z());
    } else {
      std::printf("%s no pose: %s\n", frame->stamp.c_str(), result.reason());
    }
  }
  int tracked = 0;  // Finish(): last adjustment; without it poses and map are not complete
  for (const alidade::FramePose& pose : slam.Finish()) tracked += pose.tracked;
  std::fprintf(stderr, "%d of %d frames have a pose\n", tracked, slam.frames());
  alidade::AtomicWriteFile(arguments[2], slam.SaveMap());
  return 0;
} catch (const alidade::Error& error) {  // bad input: what, where, and what to do
  std::fprintf(stderr, "track_images: %s\n", error.what());
  return static_cast<int>(error.kind());
}
