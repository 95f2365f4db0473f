#include "alidade/semidense/epipolar_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "alidade/semidense/pixel_transfer.h"

namespace alidade {
namespace {

static_assert(kDirectionSteps == GradientImage::kTurn);

struct Directions {
  std::array<float, GradientImage::kTurn> x, y;
  Directions() {
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] =
          static_cast<float>(std::cos(2 * CV_PI * static_cast<double>(i) / GradientImage::kTurn));
      y[i] =
          static_cast<float>(std::sin(2 * CV_PI * static_cast<double>(i) / GradientImage::kTurn));
    }
  }
};

const Directions& AllDirections() {
  static const Directions directions;
  return directions;
}

Plane PlaneOf(const cv::Mat& image) {
  return {image.data, static_cast<std::ptrdiff_t>(image.step[0])};
}

LinePair LinesOf(const EpipolarPair& pair, const Camera& camera,
                 const SemiDenseSettings& settings) {
  const PixelTransfer to_other(camera, pair.T_other_reference);
  const Eigen::Vector3f epipole = PixelTransfer(camera, pair.T_other_reference.Inverse()).shift;
  const Eigen::Matrix3d& R = pair.T_other_reference.R;
  const double turn = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  LinePair lines;
  lines.width = camera.width;
  lines.height = camera.height;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) lines.at_infinity[i][k] = to_other.at_infinity(i, k);
    lines.shift[i] = to_other.shift[i];
    lines.epipole[i] = epipole[i];
  }
  lines.least_cosine = static_cast<float>(std::cos(settings.max_edge_angle * CV_PI / 180));
  lines.turn = static_cast<int>(std::lround(turn / (2 * CV_PI) * GradientImage::kTurn));
  lines.max_turn = static_cast<int>(settings.max_turn / 360 * GradientImage::kTurn);
  lines.noise = static_cast<float>(settings.intensity_sigma);
  lines.line_sigma = static_cast<float>(settings.line_sigma);
  lines.max_residual2 = static_cast<float>(settings.max_residual * settings.max_residual);
  lines.reference = PlaneOf(pair.values);
  lines.other = PlaneOf(pair.other->values);
  lines.turned = PlaneOf(pair.other_turned);
  lines.direction = PlaneOf(pair.other->direction);
  return lines;
}

LineSearch FastestLineSearch() {
#ifdef ALIDADE_AVX2
  if (HasAvx2()) return LineSearch8;
#endif
  return LineSearch4;
}

}  // namespace

EpipolarPair::EpipolarPair(const GradientImage& reference_image, const GradientImage& other_image,
                           cv::Mat reference_values, const Se3& T)
    : reference(&reference_image),
      other(&other_image),
      values(std::move(reference_values)),
      T_other_reference(T) {
  cv::transpose(other->values, other_turned);
}

EpipolarSearch::EpipolarSearch(const EpipolarPair& pair, const Camera& camera,
                               const SemiDenseSettings& settings)
    : EpipolarSearch(pair, camera, settings, FastestLineSearch()) {}

EpipolarSearch::EpipolarSearch(const EpipolarPair& pair, const Camera& camera,
                               const SemiDenseSettings& settings, LineSearch search)
    : pair_(&pair),
      lines_(LinesOf(pair, camera, settings)),
      search_(search),
      lanes_(search == LineSearch4 ? 4 : 8) {}

void EpipolarSearch::Search(std::span<const EpipolarQuery> queries, std::span<Hypothesis> found,
                            SearchCount& count) {
  const Directions& directions = AllDirections();
  LineQueries& lines = queries_;
  lines.intervals = 0;
  lines.count = static_cast<int>(queries.size());
  for (size_t lane = 0; lane < queries.size(); ++lane) {
    const auto& [pixel, intervals] = queries[lane];
    const int step = pair_->reference->direction.at<uint8_t>(pixel.y, pixel.x);
    lines.x[lane] = pixel.x;
    lines.y[lane] = pixel.y;
    lines.gradient_step[lane] = step;
    lines.gradient_x[lane] = directions.x[step];
    lines.gradient_y[lane] = directions.y[step];
    lines.lowest[lane] = intervals[0].min;
    lines.highest[lane] = intervals[0].max;
    for (size_t i = 0; i < intervals.size(); ++i) {
      lines.min[i][lane] = intervals[i].min;
      lines.max[i][lane] = intervals[i].max;
      lines.lowest[lane] = std::min(lines.lowest[lane], intervals[i].min);
      lines.highest[lane] = std::max(lines.highest[lane], intervals[i].max);
    }
    for (size_t i = intervals.size(); i < kMostIntervals; ++i)
      lines.min[i][lane] = lines.max[i][lane] = 0;
    lines.intervals = std::max(lines.intervals, static_cast<int>(intervals.size()));
  }
  LineAnswers answers;
  search_(lines_, lines, answers);
  for (size_t lane = 0; lane < queries.size(); ++lane)
    found[lane] = {answers.inverse_depth[lane], answers.sigma[lane]};
  count.searches += answers.searches;
  count.samples += answers.samples;
}

}  // namespace alidade
