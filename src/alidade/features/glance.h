// Edge thumbnail of a frame, used to detect a stationary camera where keypoints cannot: all
// keypoints may lie on a moving object, while the static background has only edges.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct GlanceSettings {
  double min_gradient = 3;   // grey levels per pixel of the small picture; below it may be noise
  double same = 0.4;         // a gradient stays when it changes by no more than this share of it
  int cell = 12;             // pixels of the small picture
  int min_pixels = 8;        // with gradient, for a cell to count
  double still_share = 0.7;  // of them that must stay for a cell to stand still
  // Of the area all cells with structure lie about in (root of their places' covariance
  // determinant), that of those which stand still: a bonnet or a caption, fixed to the camera, lies
  // in one place.
  double min_area = 0.4;
};

// Downscales an 8-bit gray image to 240 pixels width (narrower images keep their size) and smooths
// it lightly. CV_32F.
cv::Mat Glance(const cv::Mat& image);

// Share of the image that did not move between two thumbnails, 0 to 1. Each cell with structure
// contributes the directions n of its gradients, T = Σ n n' / count. The result is the smallest
// share that the static cells have of all, over directions d: min d' Σ_static T d / d' Σ_all T d.
// An edge parallel to the camera's motion does not change either, but constrains only one
// direction. Gradients are compared because they do not depend on exposure offsets. Returns 0 if
// the sizes differ, there is no structure, or the static cells lie in one place.
double StillShare(const cv::Mat& a, const cv::Mat& b, const GlanceSettings& settings = {});

}  // namespace alidade
