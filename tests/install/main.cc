// What the README shows: images in, a state out.
#include <alidade/slam.h>

#include <cstdio>

int main() {
  const auto camera = alidade::Camera::FromFieldOfView(640, 480, 66);
  alidade::SlamSettings settings;
  alidade::Slam slam(camera, settings);
  const cv::Mat black(480, 640, CV_8UC1, cv::Scalar(0));
  const alidade::TrackResult result = slam.Track({.time = 0.5, .image = black});
  std::printf("%d keyframes\n", slam.Snapshot().keyframe_count());
  return result.state == alidade::TrackState::kInitialising ? 0 : 1;
}
