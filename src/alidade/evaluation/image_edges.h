// Finds strong gradients and edges of an image.
#pragma once

#include <opencv2/core.hpp>

namespace alidade {

struct ImageEdges {
  cv::Mat1b gradient;  // 255 at strong gradients
  cv::Mat1b edge;      // 255 on thinned edges; a subset of `gradient`, never on the image border
};

// `image`: CV_8U. `min_gradient`: gray levels per pixel, magnitude of Scharr's derivatives / 32.
// Edges are thinned as in Canny (1986): maxima along the gradient, in one of four directions.
ImageEdges FindImageEdges(const cv::Mat& image, double min_gradient);

}  // namespace alidade
