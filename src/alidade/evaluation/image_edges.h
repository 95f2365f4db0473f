// Where an image has structure: strong gradients, and the edges they belong to.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

struct ImageEdges {
  cv::Mat1b gradient;  // 255 where the gradient is strong
  cv::Mat1b edge;      // 255 on thinned edges: a subset, not on the outermost pixels
};

// `image`: CV_8U. `min_gradient`: grey levels per pixel, as the magnitude of Scharr's derivatives
// / 32. Edges are thinned as Canny (1986) does it: maxima along the gradient, in one of four
// directions.
ImageEdges FindImageEdges(const cv::Mat& image, double min_gradient);

}  // namespace alidade
