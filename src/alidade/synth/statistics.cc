#include "alidade/synth/statistics.h"

#include <numbers>
#include <opencv2/core.hpp>

#include "alidade/base/median.h"

namespace alidade {
namespace {

double Share(int part, const cv::Mat& of) {
  return static_cast<double>(part) / static_cast<double>(of.total());
}

}  // namespace

double PlainShare(const cv::Mat& clean) {
  constexpr int kBlock = 16;        // pixels
  constexpr double kTexture = 3.0;  // gray levels
  int plain = 0, blocks = 0;
  cv::Scalar mean, deviation;
  for (int y = 0; y + kBlock <= clean.rows; y += kBlock) {
    for (int x = 0; x + kBlock <= clean.cols; x += kBlock) {
      cv::meanStdDev(clean(cv::Rect(x, y, kBlock, kBlock)), mean, deviation);
      plain += deviation[0] < kTexture;
      ++blocks;
    }
  }
  return blocks > 0 ? static_cast<double>(plain) / blocks : 0;
}

void StatisticsCollector::AddPose(const Se3& T_world_camera) { poses_.push_back(T_world_camera); }

void StatisticsCollector::AddFrame(const RenderedFrame& frame) {
  plain_ += PlainShare(frame.clean);
  missing_ += 1 - Share(cv::countNonZero(frame.depth), frame.depth);
  actors_ += Share(cv::countNonZero(frame.mask), frame.mask);
  ++pictures_;
}

SynthStatistics StatisticsCollector::Result() const {
  SynthStatistics result;
  result.frames = static_cast<int>(poses_.size());
  std::vector<double> speeds, turns;
  for (size_t i = 1; i < poses_.size(); ++i) {
    const double step = (poses_[i].t - poses_[i - 1].t).norm();
    result.path_length += step;
    speeds.push_back(step * fps_);
    turns.push_back(RotationAngle(poses_[i], poses_[i - 1]) * 180 / std::numbers::pi * fps_);
  }
  if (!speeds.empty()) {
    result.median_speed = UpperMedian(speeds);
    result.median_turn = UpperMedian(turns);
  }
  if (pictures_ > 0) {
    result.plain_share = plain_ / pictures_;
    result.missing_depth = missing_ / pictures_;
    result.actor_share = actors_ / pictures_;
  }
  return result;
}

}  // namespace alidade
