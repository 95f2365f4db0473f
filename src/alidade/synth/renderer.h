// Ray casting: what a camera sees of a scene, colours gathered as by a pixel, depth, and where
// people are.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/synth/scene.h"
#include "alidade/synth/stage.h"

namespace alidade {

struct View {
  cv::Mat1f grey;   // grey levels, without noise
  cv::Mat1f depth;  // metres along z through the pixel's centre, 0 = nothing
  cv::Mat1b actor;  // 255 = an actor, through the pixel's centre
};

class ViewRenderer {
 public:
  // Keeps a reference to the scene. `fisheye`: equidistant, with the camera's size and focal
  // length.
  ViewRenderer(const Scene& scene, const Camera& camera, bool fisheye = false);
  // The same bits with any number of threads.
  View Render(const Shutter& shutter) const;

 private:
  struct Picture;
  RayBounds Bounds(const cv::Rect& pixels) const;
  void CastBand(int band, Picture& picture) const;
  void SmoothBand(int band, Picture& picture) const;

  const Scene& scene_;
  Camera camera_;
  int columns_, rows_;  // tiles
  cv::Mat1f ray_x_,
      ray_y_;  // x/z and y/z of every pixel's ray; whole tiles, and one more row and column
  std::vector<RectPlane> planes_;
};

}  // namespace alidade
