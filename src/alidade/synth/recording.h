// Synthetic recording: images, depth and masks of a rendered scene, with exact poses.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/synth/flight.h"
#include "alidade/synth/imu_track.h"
#include "alidade/synth/settings.h"

namespace alidade {

struct RenderedFrame {
  double time = 0;  // seconds
  // CV_8U gray, as recorded by the sensor: with noise, and blur etc. if set.
  cv::Mat image;
  cv::Mat right;  // CV_8U, second camera; empty if there is none
  // CV_16U, camera().depth_factor per meter, 0 = no reading; with the errors of a depth sensor.
  cv::Mat depth;
  cv::Mat depth_exact;  // CV_32F, meters along z at the pixel center, 0 = nothing
  cv::Mat mask;         // CV_8U, 255 = actor
  cv::Mat clean;        // CV_32F, gray levels: the image before exposure drift and noise
};

class SynthRecording {
 public:
  // Builds and paints the scene (0.2 to 2 s). Throws Error (usage) on invalid settings.
  explicit SynthRecording(SynthSettings settings);
  // Along a given path, in a hall around it: images at its poses, `frames` 0 or the first of them.
  SynthRecording(SynthSettings settings, Flight flight);
  ~SynthRecording();
  SynthRecording(SynthRecording&&) noexcept;
  SynthRecording& operator=(SynthRecording&&) noexcept;

  const SynthSettings& settings() const;
  const Camera& camera() const;  // for a fisheye: its size, and the focal length at its center
  RawCamera lens() const;        // includes a fisheye lens
  int frames() const;
  double Time(int number) const;  // seconds
  // T_world_camera, exact; with a rolling shutter, that of the middle row. The world's z is up, the
  // floor is at z = 0 (of a flight: elsewhere). `number` may exceed frames(): the path continues.
  Se3 Pose(int number) const;
  const ImuTrack* imu() const;  // nullptr: without
  // Depends only on the settings and `number`, not on threads or previous calls.
  RenderedFrame Render(int number) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace alidade
