// Painters of what rooms are covered with. Each returns a CV_8U picture of the size asked for, in
// texels; `density` is texels per metre. All chance comes from `random`.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/random.h"

namespace alidade {

// Sum of octaves of smooth noise, mean about 0, amplitude about 1. `cell`: texels of the coarsest
// octave.
cv::Mat1f FractalNoise(Random& random, cv::Size size, double cell_x, double cell_y, int octaves,
                       double gain = 0.5);
cv::Mat ToGrey(const cv::Mat1f& picture);  // rounds, cuts off at 0 and 255

// Surfaces of the building.
cv::Mat PaintPlaster(Random& random, cv::Size size, double density, double tone);  // nearly plain
cv::Mat PaintBricks(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintPlanks(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintTiles(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintCarpet(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintWood(Random& random, cv::Size size, double density, double tone);  // grain along x
cv::Mat PaintFabric(Random& random, cv::Size size, double density,
                    double tone);  // plain, stripes or checks

// Things, drawn to fill the picture.
cv::Mat PaintPoster(Random& random, cv::Size size);  // no two alike
cv::Mat PaintRug(Random& random, cv::Size size);
cv::Mat PaintPage(Random& random, cv::Size size);   // print on paper
cv::Mat PaintSpine(Random& random, cv::Size size);  // back of a book
cv::Mat PaintCover(Random& random, cv::Size size);  // front of a book
cv::Mat PaintCarton(Random& random, cv::Size size);
cv::Mat PaintDoor(Random& random, cv::Size size, int number);
cv::Mat PaintDrawers(Random& random, cv::Size size, int rows, int columns, double tone);
cv::Mat PaintScreen(Random& random, cv::Size size);  // monitor with windows of text
cv::Mat PaintKeyboard(Random& random, cv::Size size);
cv::Mat PaintWindow(Random& random, cv::Size size);  // frame, and trees and houses outside
cv::Mat PaintBoard(Random& random, cv::Size size);   // whiteboard written on
cv::Mat PaintRadiator(Random& random, cv::Size size);
cv::Mat PaintLeaves(Random& random, cv::Size size);
cv::Mat PaintBand(Random& random,
                  cv::Size size);  // round a mug or a vase; left and right edge meet

// Streets: houses with windows and shops below (`tone`: the wall's), and the road.
cv::Mat PaintFacade(Random& random, cv::Size size, double density, double tone);
cv::Mat PaintAsphalt(Random& random, cv::Size size, double density, double tone);

// People. u goes once round with the front in the middle, v from top to bottom.
cv::Mat PaintHead(Random& random, cv::Size size);
struct ShirtStyle {
  double tone = 120, other = 200;  // grey levels
  int pattern = 0;                 // 0 stripes, 1 checks, else plain with a print
};
ShirtStyle PickShirt(Random& random);
cv::Mat PaintShirt(Random& random, cv::Size size, const ShirtStyle& style, bool sleeve);
cv::Mat PaintTrousers(Random& random, cv::Size size);

}  // namespace alidade
