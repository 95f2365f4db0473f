// Depth images of rendered rooms with their true poses, small and few.
#pragma once

#include <vector>

#include "alidade/features/color.h"
#include "alidade/surface/dense_view.h"
#include "alidade/surface/stereo_depth.h"
#include "alidade/synth/recording.h"

namespace alidade {

enum class DepthOf { kExact, kSensor, kStereo };

inline SynthSettings SmallRoom(bool stereo = false) {
  SynthSettings settings = SynthDefaults("room");
  settings.width = 320;
  settings.height = 240;
  settings.stereo = stereo;
  return settings;
}

inline DenseView DenseViewOf(const SynthRecording& recording, int number, DepthOf kind) {
  const RenderedFrame frame = recording.Render(number);
  DenseView view;
  view.camera = recording.camera();
  view.T_world_camera = recording.Pose(number);
  view.color = BgrOf(frame.image);
  if (kind == DepthOf::kExact) {
    view.depth = frame.depth_exact;
  } else if (kind == DepthOf::kSensor) {
    frame.depth.convertTo(view.depth, CV_32F, 1 / view.camera.depth_factor);
    view.depth = WithoutSteps(view.depth);
    view.inverse_sigma = kSensorInverseSigma;
  } else {
    const StereoMatch match = MatchStereo(frame.image, frame.right, view.camera, 0.4);
    view.depth = WithoutSteps(match.depth);
    view.inverse_sigmas = match.inverse_sigmas;
    view.inverse_sigma = kDisparitySigma / (view.camera.fx * view.camera.baseline);
  }
  return view;
}

// Every `step`-th frame once around.
inline std::vector<DenseView> DenseViewsOf(const SynthRecording& recording, int step,
                                           DepthOf kind) {
  std::vector<DenseView> views;
  for (int i = 0; i < recording.frames(); i += step)
    views.push_back(DenseViewOf(recording, i, kind));
  return views;
}

// A camera that looks at a plane across its view, `z` meters away.
inline DenseView FlatView(double z, int width = 64, int height = 48) {
  DenseView view;
  view.camera = Camera::FromFieldOfView(width, height, 60);
  view.depth = cv::Mat1f(height, width, static_cast<float>(z));
  view.inverse_sigma = 0.001;
  return view;
}

}  // namespace alidade
