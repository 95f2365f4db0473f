// Procedural textures of surfaces and objects. Each returns a CV_8U image of the given size
// (texels); `density` is in texels per meter. All randomness comes from `random`.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/random.h"

namespace alidade {

// Sum of octaves of smooth noise with mean about 0 and amplitude about 1. `cell_x`, `cell_y`: cell
// size of the coarsest octave, texels.
cv::Mat1f FractalNoise(Random& random, cv::Size size, double cell_x, double cell_y, int octaves,
                       double gain = 0.5);
cv::Mat ToGrey(const cv::Mat1f& picture);  // rounds and clamps to [0, 255]

// Building surfaces.
cv::Mat PaintPlaster(Random& random, cv::Size size, double density, double tone);  // nearly uniform
cv::Mat PaintBricks(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintPlanks(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintTiles(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintCarpet(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintWood(Random& random, cv::Size size, double density, double tone);  // grain along x
// Uniform, stripes or checks.
cv::Mat PaintFabric(Random& random, cv::Size size, double density, double tone);

// Objects; the texture fills the image.
cv::Mat PaintPoster(Random& random, cv::Size size);  // all different
cv::Mat PaintRug(Random& random, cv::Size size);
cv::Mat PaintPage(Random& random, cv::Size size);   // printed page
cv::Mat PaintSpine(Random& random, cv::Size size);  // spine of a book
cv::Mat PaintCover(Random& random, cv::Size size);  // front cover of a book
cv::Mat PaintCarton(Random& random, cv::Size size);
cv::Mat PaintDoor(Random& random, cv::Size size, int number);
cv::Mat PaintDrawers(Random& random, cv::Size size, int rows, int columns, double tone);
cv::Mat PaintScreen(Random& random, cv::Size size);  // monitor with text windows
cv::Mat PaintKeyboard(Random& random, cv::Size size);
cv::Mat PaintWindow(Random& random, cv::Size size);  // frame with trees and houses outside
cv::Mat PaintBoard(Random& random, cv::Size size);   // whiteboard with writing
cv::Mat PaintRadiator(Random& random, cv::Size size);
cv::Mat PaintLeaves(Random& random, cv::Size size);
// For the side of a mug or vase; left and right edges match.
cv::Mat PaintBand(Random& random, cv::Size size);

// Streets: houses with windows and shops (`tone`: of the wall), and the road.
cv::Mat PaintFacade(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintAsphalt(Random& random, cv::Size size, double density, double tone);

// People. u goes once around with the front in the middle, v from top to bottom.
cv::Mat PaintHead(Random& random, cv::Size size);
struct ShirtStyle {
  double tone = 120, other = 200;  // gray levels
  int pattern = 0;                 // 0 stripes, 1 checks, otherwise uniform with a print
};
ShirtStyle PickShirt(Random& random);
cv::Mat PaintShirt(Random& random, cv::Size size, const ShirtStyle& style, bool sleeve);
cv::Mat PaintTrousers(Random& random, cv::Size size);

}  // namespace alidade
