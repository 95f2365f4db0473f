// How well what was left out agrees with where the people are.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/slam.h"

namespace alidade::bench {

struct Overlap {
  double sum = 0;       // of intersection over union, frame by frame
  int frames = 0;       // with at least one pixel in either
  double mean() const;  // NaN when there is no such frame
};

struct Share {
  int64_t part = 0, all = 0;
  void Add(bool in_part) {
    part += in_part;
    ++all;
  }
  double percent() const;  // NaN of nothing
};

struct MaskScores {
  Overlap mask;       // of the mask of movers
  Share used_static;  // features in use: those that stand still
  // Features that stand still inside boxes: those in use.
  Share kept_in_detected, kept_in_people;
  Share map_on_people, depth_on_people;  // observations of landmarks, semi-dense pixels
};

// Features with at least this static probability are in use: they may enter the map.
inline constexpr float kInUse = 0.5f;

// Intersection over union; -1 when both are empty. CV_8U of one size.
double IntersectionOverUnion(const cv::Mat& a, const cv::Mat& b);
void AddOverlap(const cv::Mat& truth, const cv::Mat& mask, Overlap& overlap);
cv::Mat Filled(cv::Size size, std::span<const cv::Rect> boxes);  // 255 inside

// One frame. `truth`: CV_8U, 255 = people; `movers`: what was left out, of any size, may be empty;
// features in pixels of an image `width` wide.
void AddFrame(const cv::Mat& truth, std::span<const cv::Rect> detected,
              std::span<const cv::Rect> people, const cv::Mat& movers,
              std::span<const FeatureUse> features, int width, MaskScores& scores);

// What of the map lies on people in its keyframes. `masks`: of each frame, by its number.
void AddMap(const MapSnapshot& map, const Camera& camera, std::span<const cv::Mat> masks,
            MaskScores& scores);

}  // namespace alidade::bench
