// What stands in rooms. Everything is placed by the middle of its footprint and seen from its
// front.
#pragma once

#include <Eigen/Core>

#include "alidade/synth/paint.h"
#include "alidade/synth/scene.h"

namespace alidade {

// A frame standing on the floor or on a table: x to the right and y away from who looks at the
// front, z up.
struct Place {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // metres
  double yaw = 0;                                    // radians about z; 0: axes as the world's

  Eigen::Vector3d Point(double x, double y, double z) const;
  Eigen::Vector3d Direction(double x, double y, double z) const;
  Place At(double x, double y, double z, double turn = 0) const {
    return {Point(x, y, z), yaw + turn};
  }
};

// Textures of a box's faces; -1: not drawn.
struct BoxFaces {
  int front = -1, back = -1, left = -1, right = -1, top = -1, bottom = -1;
  static BoxFaces All(int texture) {
    return {texture, texture, texture, texture, texture, texture};
  }
};

// Builds with one texture density (texels per metre) for what may be looked at from near.
class Furnisher {
 public:
  Furnisher(SceneBuilder& builder, double density) : builder_(builder), density_(density) {}
  SceneBuilder& builder() { return builder_; }
  Random& random() { return builder_.random(); }
  double density() const { return density_; }

  // Textures to the size they will have.
  using SizedPainter = cv::Mat (*)(Random&, cv::Size);
  using ToneFn = cv::Mat (*)(Random&, cv::Size, double, double);
  int Picture(SizedPainter paint, double width, double height, double scale = 1);
  int Material(ToneFn paint, double width, double height, double tone, double scale = 1);

  // [x, x + w] × [y, y + d] × [z, z + h] in the place's frame.
  void Box(const Place& place, const Eigen::Vector3d& corner, const Eigen::Vector3d& size,
           const BoxFaces& faces);
  void WoodBox(const Place& place, const Eigen::Vector3d& corner, const Eigen::Vector3d& size,
               double tone);
  void Shade(const Place& place, const Eigen::Vector3d& corner,
             const Eigen::Vector3d& size);  // casts shadows
  // Upright round thing: radii at its foot and its rim.
  void Round(const Place& place, double x, double y, double z, double height, double foot,
             double rim, int texture);
  void Ball(const Place& place, double x, double y, double z, const Eigen::Vector3d& radii,
            int texture);
  // Something flat on a wall, its middle at height z; the place stands at the wall's foot, front to
  // the room.
  void Hang(const Place& wall, double x, double z, double width, double height, int texture,
            double thickness = 0.012);

  // Furniture.
  void Table(const Place& place, double width, double depth, double height);
  void Chair(const Place& place);
  void Shelf(const Place& place, double width, double depth, double height);  // full of books
  void Cabinet(const Place& place, double width, double depth, double height, int rows,
               int columns);
  void Sofa(const Place& place, double width);
  void Bed(const Place& place);
  void FloorLamp(const Place& place);
  void PottedPlant(const Place& place, double height);
  void Cartons(const Place& place, int count);
  void Monitor(const Place& place);
  void Mug(const Place& place);
  void BookPile(const Place& place, int count);
  void BookRow(const Place& place, double width, double depth, double height);  // standing books
  void Pages(const Place& place, int count);                                    // paper lying about
  void Clutter(const Place& place, double width, double depth,
               int count);  // things all over a surface

  // On walls.
  void Poster(const Place& wall, double x, double z, double width, double height);
  void Door(const Place& wall, double x, int number);
  void Window(const Place& wall, double x);  // and the radiator below it

 private:
  SceneBuilder& builder_;
  double density_;
};

// The shell of a room. Corners on the floor, counter-clockwise seen from above.
struct WallFinish {
  Furnisher::ToneFn paint = PaintPlaster;
  double tone = 185;
};

// From a to b with the room on the left. Openings are [from, to] in metres along it, 2.1 m high, to
// be given in order.
struct Opening {
  double from, to;
};
void AddWall(Furnisher& furnish, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double height,
             const WallFinish& finish, const std::vector<Opening>& openings = {});
void AddFloor(Furnisher& furnish, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
              Furnisher::ToneFn paint, double tone);
void AddCeiling(Furnisher& furnish, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                double height);
// Where things hang on or stand against the wall from a to b: `along` metres from a, front to the
// room.
Place AtWall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double along, double off = 0);

}  // namespace alidade
