// A small picture of a frame, to tell whether the camera stood still where keypoints cannot: all of
// them may be on the one thing that moves, while what stays has edges only.
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

// 240 pixels wide (or as wide as it is), lightly smoothed, CV_32F. `image`: 8 bit grey.
cv::Mat Glance(const cv::Mat& image);

// How much of the picture stayed where it was, 0…1. Each cell with structure counts by the
// directions of its gradients, T = Σ n n' / count; the least that the cells which stand still have
// of all, over directions d: min d' Σ_still T d / d' Σ_all T d. Edges along which a camera moves
// stay, too, but only in one direction. Gradients are compared, so that exposure does not matter.
// 0 when the two differ in size, show no structure, or what stands still lies in one place.
double StillShare(const cv::Mat& a, const cv::Mat& b, const GlanceSettings& settings = {});

}  // namespace alidade
