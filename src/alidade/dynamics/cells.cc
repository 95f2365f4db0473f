#include "alidade/dynamics/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <span>

#include "alidade/base/median.h"
#include "alidade/features/depth_image.h"

namespace alidade {
namespace {

// Median of the positive values read at nine positions of each cell; 0 when fewer than `least` are
// positive.
template <typename Read>
std::vector<float> Medians(const Cells& cells, cv::Size image, int least, Read&& read) {
  std::vector<float> medians(cells.count(), 0);
  const float step = cells.size() / 3;
  for (int i = 0; i < cells.count(); ++i) {
    const cv::Point2f centre = cells.Centre(i);
    std::array<float, 9> values;
    int count = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = static_cast<int>(centre.x + static_cast<float>(dx) * step + 0.5f);
        const int y = static_cast<int>(centre.y + static_cast<float>(dy) * step + 0.5f);
        if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
        const float value = read(x, y);
        if (value > 0 && std::isfinite(value)) values[count++] = value;
      }
    }
    if (count < least) continue;
    medians[i] = UpperMedian(std::span(values).first(count));
  }
  return medians;
}

}  // namespace

Cells::Cells(const Camera& camera)
    : camera_(camera),
      distorted_(camera.HasDistortion()),
      size_(static_cast<float>(camera.width) / kColumns),
      rows_(std::max(1, static_cast<int>(std::lround(static_cast<float>(camera.height) / size_)))) {
  rays_.reserve(count());
  for (int i = 0; i < count(); ++i) {
    const Eigen::Vector2d raw(Centre(i).x, Centre(i).y);
    rays_.push_back(camera_.Unproject(distorted_ ? camera_.Undistort(raw) : raw));
    reach2_ = std::max(reach2_, 1.2 * rays_.back().head<2>().squaredNorm());
  }
}

int Cells::At(float x, float y) const {
  const int c = std::clamp(static_cast<int>((x + 0.5f) / size_), 0, kColumns - 1);
  const int r = std::clamp(static_cast<int>((y + 0.5f) / size_), 0, rows_ - 1);
  return r * kColumns + c;
}

cv::Point2f Cells::Centre(int cell) const {
  return {(static_cast<float>(cell % kColumns) + 0.5f) * size_ - 0.5f,
          (static_cast<float>(cell / kColumns) + 0.5f) * size_ - 0.5f};
}

int Cells::Project(const Eigen::Vector3d& p) const {
  if (!(p.z() > 0.01)) return -1;
  if (p.head<2>().squaredNorm() > reach2_ * p.z() * p.z())
    return -1;  // lens distortion models are not monotonic out there
  const Eigen::Vector2d ideal = camera_.Project(p);
  if (!(std::abs(ideal.x()) < 1e4 && std::abs(ideal.y()) < 1e4)) return -1;
  const Eigen::Vector2d raw = distorted_ ? camera_.Distort(ideal) : ideal;
  if (!(raw.x() >= -0.5 && raw.y() >= -0.5 && raw.x() < camera_.width - 0.5 &&
        raw.y() < camera_.height - 0.5))
    return -1;
  return At(static_cast<float>(raw.x()), static_cast<float>(raw.y()));
}

std::vector<float> DepthOfCells(const Cells& cells, const Camera& camera, const cv::Mat& depth,
                                const CellDepthSettings& settings) {
  const DepthImage image(depth, camera);
  return Medians(cells, image.size(), settings.min_readings,
                 [&](int x, int y) { return image.At(x, y); });
}

std::vector<float> StereoDepthOfCells(const Cells& cells, const Camera& camera, const cv::Mat& left,
                                      const cv::Mat& right, const CellDepthSettings& settings) {
  constexpr int kShrink = 2;
  constexpr int kSixteenths = 16;  // of a pixel: the unit of OpenCV's disparities
  cv::Mat small_left, small_right, disparity;
  const cv::Size size(left.cols / kShrink, left.rows / kShrink);
  cv::resize(left, small_left, size, 0, 0, cv::INTER_AREA);
  cv::resize(right, small_right, size, 0, 0, cv::INTER_AREA);
  // Disparity of the nearest depth in pixels of the reduced image, d = b f / z.
  const double widest = camera.bf() / settings.stereo_nearest / kShrink;
  const int disparities = std::clamp(static_cast<int>(std::ceil(widest / 16)) * 16, 16,
                                     std::max(16, size.width / 32 * 16));
  const auto matcher = cv::StereoBM::create(disparities, settings.stereo_window);
  matcher->setTextureThreshold(settings.stereo_texture);
  matcher->setUniquenessRatio(settings.stereo_uniqueness);
  matcher->setSpeckleWindowSize(0);
  matcher->compute(small_left, small_right, disparity);
  const auto bf = static_cast<float>(camera.bf() * kSixteenths / kShrink);
  return Medians(cells, left.size(), settings.min_readings, [&](int x, int y) {
    const int v = std::min(y / kShrink, size.height - 1), u = std::min(x / kShrink, size.width - 1);
    const int16_t d = disparity.at<int16_t>(v, u);
    return d > kSixteenths ? bf / static_cast<float>(d) : 0.0f;
  });
}

}  // namespace alidade
