#include "alidade/evaluation/depth_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "alidade/base/error.h"
#include "alidade/evaluation/image_edges.h"

namespace alidade {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string SizeText(const cv::Mat& image) {
  return std::to_string(image.cols) + "x" + std::to_string(image.rows);
}

void CheckFrame(const DepthFrame& frame) {
  const auto& [estimate, truth, image, map] = frame;
  if (estimate.type() != CV_32F || truth.type() != CV_32F || image.type() != CV_8U)
    ThrowInput("depth must be 32-bit float and the image 8-bit gray");
  if (estimate.empty() || truth.empty()) ThrowInput("a depth image is empty");
  if (truth.size() != image.size())
    ThrowInput("true depth of " + SizeText(truth) + " for an image of " + SizeText(image));
  // A smaller estimate must cover the same view: its height follows from its width, within one
  // pixel for rounding.
  const double height = static_cast<double>(truth.rows) * estimate.cols / truth.cols;
  if (estimate.cols > truth.cols || estimate.rows > truth.rows ||
      std::abs(estimate.rows - height) > 1) {
    ThrowInput("depth of " + SizeText(estimate) + " does not fit images of " + SizeText(truth));
  }
  if (map < 0) ThrowInput("a map's number cannot be negative");
}

cv::Mat1b Known(const cv::Mat1f& depth) {
  const cv::Mat finite = depth < std::numeric_limits<float>::infinity();  // also false for NaN
  cv::Mat1b known = depth > 0;
  known &= finite;
  return known;
}

// Marks known pixels whose known neighborhood has similar true depth, as
// DepthErrorSettings::continuity defines.
cv::Mat1b Continuous(const cv::Mat1f& truth, const cv::Mat1b& known,
                     const DepthErrorSettings& settings) {
  const cv::Mat window =
      cv::Mat::ones(settings.continuity_window, settings.continuity_window, CV_8U);
  cv::Mat1f nearest(truth.size(), std::numeric_limits<float>::max()), farthest(truth.size(), 0.f);
  truth.copyTo(nearest, known);
  truth.copyTo(farthest, known);
  cv::erode(nearest, nearest, window);
  cv::dilate(farthest, farthest, window);
  cv::Mat1b continuous = nearest >= (1 - settings.continuity) * truth;
  continuous &= farthest <= (1 + settings.continuity) * truth;
  continuous &= known;
  return continuous;
}

int64_t Count(const cv::Mat& mask) { return cv::countNonZero(mask); }

// Reorders `values`.
double Median(std::vector<float>& values) {
  if (values.empty()) return kNaN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (double{*middle} + double{*std::max_element(values.begin(), middle)});
}

// The smallest value that is not exceeded by the given share of all values. Reorders `values`.
double Percentile(std::vector<float>& values, double share) {
  if (values.empty()) return kNaN;
  // Counted from 1.
  const double rank = std::ceil(share * static_cast<double>(values.size()) - 1e-9);
  const auto at =
      values.begin() + std::max<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(rank) - 1, 0);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double Share(int64_t part, int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : kNaN;
}

}  // namespace

void DepthErrorSettings::Check() const {
  if (!(min_gradient >= 0)) ThrowUsage("min_gradient cannot be negative (gray levels per pixel)");
  if (!(continuity > 0 && continuity < 1)) ThrowUsage("continuity must be a share between 0 and 1");
  if (continuity_window < 1 || continuity_window % 2 == 0)
    ThrowUsage("continuity_window must be an odd number of pixels");
}

DepthScorer::DepthScorer(const DepthErrorSettings& settings) : settings_(settings) {
  settings_.Check();
}

void DepthScorer::Add(const DepthFrame& given) {
  CheckFrame(given);
  const cv::Mat1f estimate = given.estimate, truth = given.truth;
  const cv::Mat1b has_depth = Known(estimate), known = Known(truth);
  const cv::Mat1b continuous = Continuous(truth, known, settings_);
  Frame frame;
  frame.map = given.map;
  const double step_x = static_cast<double>(truth.cols) / estimate.cols;
  const double step_y = static_cast<double>(truth.rows) / estimate.rows;
  for (int y = 0; y < estimate.rows; ++y) {
    const int truth_y =
        // The truth's pixel that contains the center of the estimate's pixel.
        static_cast<int>((y + 0.5) * step_y);
    for (int x = 0; x < estimate.cols; ++x) {
      if (has_depth(y, x) == 0) continue;
      const int truth_x = static_cast<int>((x + 0.5) * step_x);
      if (known(truth_y, truth_x) == 0) continue;
      auto& pairs = continuous(truth_y, truth_x) != 0 ? frame.continuous : frame.other;
      pairs.push_back({estimate(y, x), truth(truth_y, truth_x)});
    }
  }

  cv::Mat image = given.image;
  if (image.size() != estimate.size())
    cv::resize(image, image, estimate.size(), 0, 0, cv::INTER_AREA);
  const ImageEdges edges = FindImageEdges(image, settings_.min_gradient);
  cv::Mat beside_depth;
  cv::dilate(has_depth, beside_depth, cv::Mat::ones(3, 3, CV_8U));
  frame.pixels = {static_cast<int64_t>(estimate.total()), Count(has_depth)};
  frame.gradient = {Count(edges.gradient), Count(edges.gradient & has_depth)};
  frame.edge = {Count(edges.edge), Count(edges.edge & beside_depth)};
  frames_.push_back(std::move(frame));
}

DepthScore DepthScorer::Score(std::span<const Frame> frames, const std::vector<double>& scales,
                              bool continuous_only) {
  DepthScore score;
  std::vector<float> errors;
  double sum_inv = 0;
  int64_t within_2 = 0, within_5 = 0, within_10 = 0;
  for (const Frame& frame : frames) {
    score.scale = scales[static_cast<size_t>(frame.map)];
    const auto add = [&](const std::vector<Pair>& pairs) {
      for (const Pair& pair : pairs) {
        const double z = score.scale * pair.estimate, truth = pair.truth;
        const double error = std::abs(z - truth) / truth, inv = 1 / z - 1 / truth;
        within_2 += error <= 0.02;
        within_5 += error <= 0.05;
        within_10 += error <= 0.10;
        sum_inv += inv * inv;
        errors.push_back(static_cast<float>(error));
      }
    };
    add(frame.continuous);
    if (!continuous_only) add(frame.other);
  }
  score.n = static_cast<int64_t>(errors.size());
  score.median_rel = Median(errors);
  score.p90_rel = Percentile(errors, 0.9);
  score.within_2 = Share(within_2, score.n);
  score.within_5 = Share(within_5, score.n);
  score.within_10 = Share(within_10, score.n);
  score.rmse_inv = score.n > 0 ? std::sqrt(sum_inv / static_cast<double>(score.n)) : kNaN;
  score.density = ShareWithDepth(frames, &Frame::pixels);
  score.density_gradient = ShareWithDepth(frames, &Frame::gradient);
  score.edge_coverage = ShareWithDepth(frames, &Frame::edge);
  return score;
}

double DepthScorer::ShareWithDepth(std::span<const Frame> frames, Coverage Frame::*which) {
  int64_t all = 0, with_depth = 0;
  for (const Frame& frame : frames) {
    all += (frame.*which).all;
    with_depth += (frame.*which).with_depth;
  }
  return Share(with_depth, all);
}

std::vector<double> DepthScorer::Scales() const {
  size_t maps = 1;
  for (const Frame& frame : frames_) maps = std::max(maps, static_cast<size_t>(frame.map) + 1);
  std::vector<double> scales(maps, 1);
  if (!settings_.fit_scale) return scales;
  std::vector<std::vector<float>> ratios(maps);
  for (const Frame& frame : frames_) {
    for (const auto* pairs : {&frame.continuous, &frame.other}) {
      for (const Pair& pair : *pairs)
        ratios[static_cast<size_t>(frame.map)].push_back(pair.truth / pair.estimate);
    }
  }
  for (size_t i = 0; i < maps; ++i) scales[i] = Median(ratios[i]);
  return scales;
}

DepthErrorResult DepthScorer::Result() const {
  DepthErrorResult result;
  result.scales = Scales();
  const auto scores = [&](std::span<const Frame> frames) {
    return DepthScores{Score(frames, result.scales, false), Score(frames, result.scales, true)};
  };
  result.overall = scores(frames_);
  result.overall.all.scale = result.overall.continuous.scale = result.scales.front();
  for (const Frame& frame : frames_) result.frames.push_back(scores({&frame, 1}));
  return result;
}

DepthErrorResult ScoreDepth(std::span<const DepthFrame> frames,
                            const DepthErrorSettings& settings) {
  DepthScorer scorer(settings);
  for (const DepthFrame& frame : frames) scorer.Add(frame);
  return scorer.Result();
}

}  // namespace alidade
