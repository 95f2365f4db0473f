// A typical RGB-D camera, for tests that need no particular one.
#pragma once

#include "alidade/geometry/camera.h"

namespace alidade {

// 640 × 480 pixels, focal length 525, principal point at the center, no distortion.
inline Camera MakeVgaCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 525;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

}  // namespace alidade
