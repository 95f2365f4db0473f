#include "bench/dynamic/mask_scores.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace alidade::bench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// Whether a mask is set at a pixel of an image `scale` times smaller.
bool At(const cv::Mat& mask, double x, double y, double scale) {
  // Pixel centres are at whole numbers: the corner of the picture, at -0.5, is where scales meet.
  const int column = static_cast<int>(std::floor((x + 0.5) * scale));
  const int row = static_cast<int>(std::floor((y + 0.5) * scale));
  if (column < 0 || row < 0 || column >= mask.cols || row >= mask.rows) return false;
  return mask.at<uchar>(row, column) != 0;
}

}  // namespace

double Overlap::mean() const { return frames > 0 ? sum / frames : kUndefined; }
double Share::percent() const {
  return all > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(all) : kUndefined;
}

double IntersectionOverUnion(const cv::Mat& a, const cv::Mat& b) {
  const int either = cv::countNonZero(a | b);
  return either > 0 ? static_cast<double>(cv::countNonZero(a & b)) / either : -1;
}

void AddOverlap(const cv::Mat& truth, const cv::Mat& mask, Overlap& overlap) {
  const double iou = IntersectionOverUnion(truth, mask);
  if (iou < 0) return;
  overlap.sum += iou;
  ++overlap.frames;
}

cv::Mat Filled(cv::Size size, std::span<const cv::Rect> boxes) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  for (const cv::Rect& box : boxes) mask(box & cv::Rect({0, 0}, size)) = 255;
  return mask;
}

void AddFrame(const cv::Mat& truth, std::span<const cv::Rect> detected,
              std::span<const cv::Rect> people, const cv::Mat& movers,
              std::span<const FeatureUse> features, int width, MaskScores& scores) {
  if (truth.empty()) return;
  if (!movers.empty()) {
    cv::Mat mask = movers;
    if (mask.size() != truth.size())
      cv::resize(movers, mask, truth.size(), 0, 0, cv::INTER_NEAREST);
    AddOverlap(truth, mask, scores.mask);
  }
  const cv::Mat in_detected = Filled(truth.size(), detected);
  const cv::Mat in_people = Filled(truth.size(), people);
  const double scale = static_cast<double>(truth.cols) / width;
  for (const FeatureUse& feature : features) {
    const bool used = feature.static_probability >= kInUse;
    const bool still = !At(truth, feature.x, feature.y, scale);
    if (used) scores.used_static.Add(still);
    if (!still) continue;
    if (At(in_detected, feature.x, feature.y, scale)) scores.kept_in_detected.Add(used);
    if (At(in_people, feature.x, feature.y, scale)) scores.kept_in_people.Add(used);
  }
}

void AddMap(const MapSnapshot& map, const Camera& camera, std::span<const cv::Mat> masks,
            MaskScores& scores) {
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    const auto number = static_cast<size_t>(keyframe.frame->number);
    if (number >= masks.size() || masks[number].empty()) continue;
    const cv::Mat& mask = masks[number];
    const double scale = static_cast<double>(mask.cols) / camera.width;
    for (size_t k = 0; k < keyframe.landmarks.size(); ++k) {
      if (!keyframe.landmarks[k].valid() || !map.Find(keyframe.landmarks[k])) continue;
      const Keypoint& keypoint = keyframe.frame->keypoints[k];
      scores.map_on_people.Add(At(mask, keypoint.raw_x, keypoint.raw_y, scale));
    }
    if (!keyframe.depth) continue;
    for (const DepthPixel& pixel : keyframe.depth->pixels) {
      Eigen::Vector2d raw(pixel.x, pixel.y);
      if (camera.HasDistortion()) raw = camera.Distort(raw);
      scores.depth_on_people.Add(At(mask, raw.x(), raw.y(), scale));
    }
  }
}

}  // namespace alidade::bench
