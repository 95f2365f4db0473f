// What the painters of things share: choices, print, shapes and frames.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/random.h"

namespace alidade {

// Draws of one call are in a fixed order only where they stand in statements or braces of their
// own: the order of a call's arguments is the compiler's, and a recording must be the same with
// every compiler.
int Pick(Random& random, int low, int high);  // both included
cv::Point PickPoint(Random& random, cv::Size size);
double Contrasting(Random& random, double other,
                   double apart = 50);  // a tone at least `apart` from `other`

cv::Mat Blank(cv::Size size, double tone);

// Print that fills a box: a line is `line` texels high.
void WriteText(Random& random, cv::Mat& picture, cv::Rect box, double line, double tone);
void DrawShape(Random& random, cv::Mat& picture, double smallest, double largest);  // radii, texels
void DrawFrame(cv::Mat& picture, int width, double tone);

}  // namespace alidade
