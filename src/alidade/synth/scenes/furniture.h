// Furniture of rooms. Objects are positioned by the middle of their footprint and face the viewer.
#pragma once

#include <Eigen/Core>

#include "alidade/synth/paint/paint.h"
#include "alidade/synth/scene.h"

namespace alidade {

// Local frame of an object on the floor or a table: x to the right and y away from a viewer of its
// front, z up.
struct Place {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // meters
  double yaw = 0;  // radians about z; 0: parallel to the world's axes

  Eigen::Vector3d Point(double x, double y, double z) const;
  Eigen::Vector3d Direction(double x, double y, double z) const;
  Place At(double x, double y, double z, double turn = 0) const {
    return {Point(x, y, z), yaw + turn};
  }
};

// Texture indices of a box's faces; -1: not drawn.
struct BoxFaces {
  int front = -1, back = -1, left = -1, right = -1, top = -1, bottom = -1;
  static BoxFaces All(int texture) {
    return {texture, texture, texture, texture, texture, texture};
  }
};

// Builds objects with one texture density (texels per meter).
class Furnisher {
 public:
  Furnisher(SceneBuilder& builder, double density) : builder_(builder), density_(density) {}
  SceneBuilder& builder() { return builder_; }
  Random& random() { return builder_.random(); }
  double density() const { return density_; }

  // Painters of textures of a given size.
  using SizedPainter = cv::Mat (*)(Random&, cv::Size);
  using ToneFn = cv::Mat (*)(Random&, cv::Size, double, double);
  int Picture(SizedPainter paint, double width, double height, double scale = 1);
  int Material(ToneFn paint, double width, double height, double tone, double scale = 1);

  // Box [x, x + w] × [y, y + d] × [z, z + h] in the frame of `place`.
  void Box(const Place& place, const Eigen::Vector3d& corner, const Eigen::Vector3d& size,
           const BoxFaces& faces);
  void WoodBox(const Place& place, const Eigen::Vector3d& corner, const Eigen::Vector3d& size,
               double tone);
  // Adds an obstacle that casts soft shadows.
  void Shade(const Place& place, const Eigen::Vector3d& corner, const Eigen::Vector3d& size);
  // Upright cone frustum with radii at the foot and the rim.
  void Round(const Place& place, double x, double y, double z, double height, double foot,
             double rim, int texture);
  void Ball(const Place& place, double x, double y, double z, const Eigen::Vector3d& radii,
            int texture);
  // Flat object on a wall with its middle at height z; `wall` is at the foot of the wall, facing
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
  void Pages(const Place& place, int count);                                    // sheets of paper
  // Small objects on a surface.
  void Clutter(const Place& place, double width, double depth, int count);

  // On walls.
  void Poster(const Place& wall, double x, double z, double width, double height);
  void Door(const Place& wall, double x, int number);
  void Window(const Place& wall, double x);  // with the radiator below it

 private:
  SceneBuilder& builder_;
  double density_;
};

// Finish of a room's walls. Corners are on the floor, counter-clockwise seen from above.
struct WallFinish {
  Furnisher::ToneFn paint = PaintPlaster;
  double tone = 185;
};

// Opening in a wall, [from, to] in meters along it, 2.1 m high. AddWall() builds the wall from a to
// b with the room on the left; openings must be in ascending order.
struct Opening {
  double from, to;
};
void AddWall(Furnisher& furnish, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double height,
             const WallFinish& finish, const std::vector<Opening>& openings = {});
void AddFloor(Furnisher& furnish, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
              Furnisher::ToneFn paint, double tone);
void AddCeiling(Furnisher& furnish, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                double height);
// Place at the foot of the wall from a to b, `along` meters from a and `off` meters into the room,
// facing the room.
Place AtWall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double along, double off = 0);

// Objects every 1.5 to 2 m along the wall, except at its openings. `outside`: it may have windows.
// `kind`: of the first object; moves on through the eight kinds.
void FillWall(Furnisher& furnish, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
              const std::vector<Opening>& openings, bool outside, int& kind);

}  // namespace alidade
