// Ray casting: what a camera sees of a scene, colours gathered as by a pixel, depth, and where
// people are.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/synth/scene.h"

namespace alidade {

struct View {
  cv::Mat1f grey;   // grey levels, without noise
  cv::Mat1f depth;  // metres along z through the pixel's centre, 0 = nothing
  cv::Mat1b actor;  // 255 = an actor, through the pixel's centre
};

// From where the picture is taken, and the people in it. With a global shutter every row is the
// same.
struct Shutter {
  std::function<Se3(double row)> T_world_camera;
  std::function<std::vector<Quadric>(double row)> actors;
  bool rolling = false;  // rows differ
};

// A rectangle as intersection wants it: on the ray c + z R d, d = (x, y, 1), the place in the
// rectangle is u = fu·d / fw·d, v = fv·d / fw·d and 1 / z = fw·d, with linear forms that depend on
// the pose only.
struct RectForms {
  float fu[3], fv[3], fw[3];
};

class ViewRenderer {
 public:
  static constexpr int kTile = 16;  // pixels, side of a tile; one list of what may be seen for each

  // Keeps a reference to the scene.
  ViewRenderer(const Scene& scene, const Camera& camera);
  // The same bits with any number of threads.
  View Render(const Shutter& shutter) const;

 private:
  struct Plane {  // a rectangle, in the world
    Eigen::Vector3d origin, normal, u, v;
    Eigen::Vector3d corners[4];
  };
  struct Bounds {  // of a tile's or a band's rays x/z and y/z
    float left, right, top, bottom;
  };
  struct Item;
  struct Stage;
  struct TileList;
  class TileCaster;

  Stage PrepareStage(const Shutter& shutter, double first_row, double last_row) const;
  TileList ListTile(const Stage& stage, const Bounds& bounds) const;
  Bounds TileBounds(int column, int row) const;

  const Scene& scene_;
  Camera camera_;
  int columns_, rows_;  // tiles
  cv::Mat1f ray_x_,
      ray_y_;  // x/z and y/z of every pixel's ray; whole tiles, and one more row and column
  std::vector<Plane> planes_;
};

}  // namespace alidade
