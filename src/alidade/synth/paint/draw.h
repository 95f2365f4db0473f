// Drawing primitives shared by the painters: random choices, text, shapes and frames.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/random.h"

namespace alidade {

// Random draws must be in separate statements or in braces: the evaluation order of function
// arguments depends on the compiler, and a recording must be the same with every compiler.
int Pick(Random& random, int low, int high);  // both bounds inclusive
cv::Point PickPoint(Random& random, cv::Size size);
// A gray level that differs from `other` by at least `apart`.
double Contrasting(Random& random, double other, double apart = 50);

cv::Mat Blank(cv::Size size, double tone);

// Text that fills a box; `line`: line height, texels.
void WriteText(Random& random, cv::Mat& picture, cv::Rect box, double line, double tone);
// `smallest`, `largest`: radius, texels.
void DrawShape(Random& random, cv::Mat& picture, double smallest, double largest);
void DrawFrame(cv::Mat& picture, int width, double tone);

}  // namespace alidade
