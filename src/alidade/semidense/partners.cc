#include "alidade/semidense/partners.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>
#include <optional>
#include <utility>

#include "alidade/map/view.h"

namespace alidade {
namespace {

// Relative to the median depth; a smaller baseline gives too little parallax.
constexpr double kLeastBaseline = 0.02;
constexpr int kEnough = 20;  // landmarks needed to estimate an exposure
constexpr int kRounds = 5;
// Gray levels; pairs of intensities with a larger residual are down-weighted.
constexpr double kTrust = 8;

std::optional<double> MeanAround(const GradientImage& image, const Keypoint& keypoint) {
  constexpr int kRadius = 3;
  const int x = static_cast<int>(keypoint.x + 0.5f), y = static_cast<int>(keypoint.y + 0.5f);
  if (x < kRadius || y < kRadius || x >= image.values.cols - kRadius ||
      y >= image.values.rows - kRadius)
    return std::nullopt;
  int sum = 0;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      sum += image.values.at<cv::Vec2b>(y + dy, x + dx)[0];
    }
  }
  return sum / static_cast<double>((2 * kRadius + 1) * (2 * kRadius + 1));
}

}  // namespace

std::vector<KeyFrameId> ChoosePartners(const MapSnapshot& map, const KeyFrame& keyframe, int count,
                                       const std::function<bool(KeyFrameId)>& usable) {
  const std::optional<double> depth = MedianDepth(map, keyframe);
  std::vector<KeyFrameId> chosen;
  if (!depth) return chosen;
  for (const Neighbour& neighbour : keyframe.covisible) {
    if (static_cast<int>(chosen.size()) == count) break;
    const KeyFrame* other = map.Find(neighbour.id);
    if (!other || !usable(neighbour.id)) continue;
    if ((other->Centre() - keyframe.Centre()).norm() < kLeastBaseline * *depth) continue;
    chosen.push_back(neighbour.id);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

Exposure CompareExposures(const KeyFrame& reference, const GradientImage& reference_image,
                          const KeyFrame& other, const GradientImage& other_image) {
  std::vector<std::pair<LandmarkId, double>> here;
  for (size_t i = 0; i < reference.landmarks.size(); ++i) {
    if (!reference.landmarks[i].valid()) continue;
    const auto mean = MeanAround(reference_image, reference.frame->keypoints[i]);
    if (mean) here.push_back({reference.landmarks[i], *mean});
  }
  std::sort(here.begin(), here.end());
  // Intensity in the reference and in the other image.
  std::vector<std::pair<double, double>> pairs;
  for (size_t i = 0; i < other.landmarks.size(); ++i) {
    const LandmarkId id = other.landmarks[i];
    if (!id.valid()) continue;
    const auto it = std::lower_bound(here.begin(), here.end(), std::pair{id, -1.0});
    if (it == here.end() || it->first != id) continue;
    const auto mean = MeanAround(other_image, other.frame->keypoints[i]);
    if (mean) pairs.push_back({it->second, *mean});
  }
  if (static_cast<int>(pairs.size()) < kEnough) return {};
  Exposure exposure;
  for (int round = 0; round < kRounds; ++round) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& [a, b] : pairs) {
      const double r = std::abs(b - exposure.gain * a - exposure.offset);
      const double w = round == 0 || r < kTrust ? 1 : kTrust / r;
      n += w;
      x += w * a;
      y += w * b;
      xx += w * a * a;
      xy += w * a * b;
    }
    const double spread = n * xx - x * x;
    if (spread < 1e-6 * n * n) return {};
    exposure.gain = std::clamp((n * xy - x * y) / spread, 0.5, 1.99);
    exposure.offset = (y - exposure.gain * x) / n;
  }
  return exposure;
}

cv::Mat WithExposure(const cv::Mat& values, const Exposure& exposure) {
  if (std::abs(exposure.gain - 1) < 0.01 && std::abs(exposure.offset) < 1) return values;
  cv::Mat result(values.size(), values.type());
  constexpr int kShift = 7;  // fractional bits of the gain: 255 times 2 still fits
  const auto gain = static_cast<uint16_t>(std::lround(exposure.gain * (1 << kShift)));
  const auto offset = static_cast<int16_t>(std::lround(exposure.offset));
  const cv::v_uint16x8 gains = cv::v_setall_u16(gain);
  const cv::v_int16x8 offsets(offset, 0, offset, 0, offset, 0, offset, 0);
  const auto changed = [&](const cv::v_uint16x8& value) {
    const cv::v_uint16x8 product = cv::v_shr<kShift>(cv::v_mul_wrap(value, gains));
    return cv::v_reinterpret_as_s16(product) + offsets;
  };
  const int bytes = 2 * values.cols;
  for (int y = 0; y < values.rows; ++y) {
    const auto* from = values.ptr<uint8_t>(y);
    auto* to = result.ptr<uint8_t>(y);
    constexpr int kBytes = 16;
    for (int i = 0; i < bytes; i += kBytes) {
      const int at = std::min(i, bytes - kBytes);  // the last block overlaps the previous one
      cv::v_uint16x8 low, high;
      cv::v_expand(cv::v_load(from + at), low, high);
      cv::v_store(to + at, cv::v_pack_u(changed(low), changed(high)));
    }
  }
  return result;
}

}  // namespace alidade
