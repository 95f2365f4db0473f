// A recording that never was: images, depth and masks of a rendered place, with exact poses.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/synth/settings.h"

namespace alidade {

struct RenderedFrame {
  double time = 0;  // seconds
  cv::Mat
      image;  // CV_8U grey, as the camera's sensor has it: with noise, and blur etc. where asked
  cv::Mat right;  // CV_8U, the second camera's; empty without one
  cv::Mat depth;  // CV_16U, camera().depth_factor per metre, 0 = none: with a depth sensor's faults
  cv::Mat depth_exact;  // CV_32F, metres along z through each pixel's centre, 0 = nothing there
  cv::Mat mask;         // CV_8U, 255 = an actor
  cv::Mat clean;        // CV_32F, grey levels: the image before exposure drift and noise
};

class SynthRecording {
 public:
  // Paints and builds the scene (0.2 s to 2 s). Throws Error on settings that cannot be.
  explicit SynthRecording(SynthSettings settings);
  ~SynthRecording();
  SynthRecording(SynthRecording&&) noexcept;
  SynthRecording& operator=(SynthRecording&&) noexcept;

  const SynthSettings& settings() const;
  const Camera& camera() const;  // of a fisheye: size, and focal length in its middle
  RawCamera lens() const;        // with a fisheye's lens, too
  int frames() const;
  double Time(int number) const;  // seconds
  // T_world_camera, exact; when rows are taken one after another, of the middle row. The world is z
  // up, its floor at z = 0. Any number will do: the path goes on beyond frames().
  Se3 Pose(int number) const;
  // Depends on the settings and the number only, not on threads or on what was rendered before.
  RenderedFrame Render(int number) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace alidade
