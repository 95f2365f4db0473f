// Ray caster: antialiased image, depth, and mask of actors of a scene from a camera.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/synth/scene.h"
#include "alidade/synth/stage.h"

namespace alidade {

struct View {
  cv::Mat1f grey;   // gray levels, without noise
  cv::Mat1f depth;  // meters along z at the pixel center, 0 = nothing
  cv::Mat1b actor;  // 255 = actor at the pixel center
};

class ViewRenderer {
 public:
  // Keeps a reference to the scene. `fisheye`: equidistant projection with the camera's size and
  // focal length.
  ViewRenderer(const Scene& scene, const Camera& camera, bool fisheye = false);
  // The result does not depend on the number of threads.
  View Render(const Shutter& shutter) const;

 private:
  struct Picture;
  RayBounds Bounds(const cv::Rect& pixels) const;
  void CastBand(int band, Picture& picture) const;
  void SmoothBand(int band, Picture& picture) const;

  const Scene& scene_;
  Camera camera_;
  int columns_, rows_;  // tiles
  // x/z and y/z of every pixel's ray, for whole tiles plus one row and column.
  cv::Mat1f ray_x_, ray_y_;
  std::vector<RectPlane> planes_;
};

}  // namespace alidade
