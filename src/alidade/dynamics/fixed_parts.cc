#include "alidade/dynamics/fixed_parts.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/dynamics/chance_to_stay.h"
#include "alidade/features/glance.h"

namespace alidade {
namespace {

constexpr int kShareCell = 12;  // pixels of the thumbnail
constexpr int kMinCorners = 8;  // pixels of a cell that shows something
constexpr int kMinCells = 10;   // of an image that shows something
constexpr float kLimit = 8;     // of the log-odds: what was believed for long may still change
constexpr double kStays = 1.5;  // pixels of the thumbnail: a point of the scene may seem to stay
constexpr int kRim = 3;         // pixels of the thumbnail: half a keypoint's patch
// A part has been seen as a whole once it grows by less than this from comparison to comparison.
constexpr double kGrows = 1.2;

float LogOdds(double probability) {
  return static_cast<float>(std::log(probability / (1 - probability)));
}

// Derivatives of a float image along one of its rows.
class RowGradients {
 public:
  RowGradients(const cv::Mat& image, int y)
      : above_(image.ptr<float>(y - 1)),
        row_(image.ptr<float>(y)),
        below_(image.ptr<float>(y + 1)) {}
  float dx(int x) const { return 0.5f * (row_[x + 1] - row_[x - 1]); }
  float dy(int x) const { return 0.5f * (below_[x] - above_[x]); }

 private:
  const float *above_, *row_, *below_;
};

}  // namespace

FixedParts::FixedParts(const Camera& camera, const FixedPartsSettings& settings)
    : camera_(camera), settings_(settings) {}

bool FixedParts::See(const cv::Mat& image, const std::shared_ptr<const Frame>& frame) {
  if (frame_then_ && frame->time - time_ < settings_.interval) return false;
  if (frame_then_ && frame->time - looked_ < settings_.interval / 3) return false;
  looked_ = frame->time;
  const cv::Mat now = Glance(image);
  if (!frame_then_ || now.size() != then_.size()) {
    if (log_odds_.size() != now.size())
      log_odds_ = cv::Mat(now.size(), CV_32F, cv::Scalar(LogOdds(settings_.prior)));
    Renew(now, frame);
    return false;
  }
  const Corners corners = Compare(now);
  const double stayed = ShareThatStayed(corners);
  const bool nothing = stayed < 0;
  // The scene stands still, or the camera does while something passes: then staying says nothing.
  GlanceSettings glance;
  glance.min_area = settings_.still_area;
  const bool rests =
      stayed > settings_.most_stay || StillShare(then_, now, glance) > settings_.most_still;
  const bool unknown = !nothing && !rests && !Weigh(corners, stayed, *frame);
  if (unknown) looked_ += settings_.interval;  // to look for the motion takes milliseconds
  if (!nothing && (rests || unknown)) {
    if (frame->time - time_ > settings_.longest) Renew(now, frame);
    return false;
  }
  Renew(now, frame);
  return !nothing && Decide();
}

void FixedParts::Renew(const cv::Mat& thumbnail, const std::shared_ptr<const Frame>& frame) {
  then_ = thumbnail;
  frame_then_ = frame;
  time_ = frame->time;
}

void FixedParts::SetCamera(const Camera& camera) {
  camera_ = camera;
  Cut();  // the keypoints of the earlier frame are those of the other camera
}

void FixedParts::Cut() { frame_then_ = nullptr; }

// Corners of the earlier thumbnail: the smaller eigenvalue of the gradients' square, averaged over
// 3 × 3 pixels. An edge is none, since it does not change when it moves along itself.
FixedParts::Corners FixedParts::Compare(const cv::Mat& thumbnail) const {
  cv::Mat xx = cv::Mat::zeros(then_.size(), CV_32F), yy = xx.clone(), xy = xx.clone(),
          change = xx.clone();
  for (int y = 1; y + 1 < then_.rows; ++y) {
    const RowGradients before(then_, y), now(thumbnail, y);
    float *const to_xx = xx.ptr<float>(y), *const to_yy = yy.ptr<float>(y),
                 *const to_xy = xy.ptr<float>(y), *const to_change = change.ptr<float>(y);
    for (int x = 1; x + 1 < then_.cols; ++x) {
      const float dx = before.dx(x), dy = before.dy(x);
      const float more_x = now.dx(x) - dx, more_y = now.dy(x) - dy;
      to_xx[x] = dx * dx;
      to_yy[x] = dy * dy;
      to_xy[x] = dx * dy;
      to_change[x] = more_x * more_x + more_y * more_y;
    }
  }
  const cv::Vec3f third = cv::Vec3f::all(1.0f / 3);  // smaller in WebAssembly than cv::blur()
  for (cv::Mat* sums : {&xx, &yy, &xy, &change})
    cv::sepFilter2D(*sums, *sums, CV_32F, third, third);
  Corners corners{cv::Mat(then_.size(), CV_8U, cv::Scalar(0)),
                  cv::Mat(then_.size(), CV_8U, cv::Scalar(0))};
  for (int y = 1; y + 1 < then_.rows; ++y) {
    for (int x = 1; x + 1 < then_.cols; ++x) {
      const float half = 0.5f * (xx.at<float>(y, x) - yy.at<float>(y, x));
      const float mean = 0.5f * (xx.at<float>(y, x) + yy.at<float>(y, x));
      const float across = xy.at<float>(y, x);
      const float smaller = mean - std::sqrt(half * half + across * across);
      if (smaller < settings_.corner) continue;
      corners.is.at<uint8_t>(y, x) = 1;
      corners.stayed.at<uint8_t>(y, x) = change.at<float>(y, x) < settings_.same * smaller;
    }
  }
  return corners;
}

double FixedParts::ShareThatStayed(const Corners& corners) const {
  double sum = 0;
  int cells = 0;
  for (int top = 0; top + kShareCell <= then_.rows; top += kShareCell) {
    for (int left = 0; left + kShareCell <= then_.cols; left += kShareCell) {
      int all = 0, stayed = 0;
      for (int y = top; y < top + kShareCell; ++y) {
        for (int x = left; x < left + kShareCell; ++x) {
          if (!corners.is.at<uint8_t>(y, x) || log_odds_.at<float>(y, x) > 0) continue;
          ++all;
          stayed += corners.stayed.at<uint8_t>(y, x);
        }
      }
      if (all < kMinCorners) continue;
      ++cells;
      sum += static_cast<double>(stayed) / all;
    }
  }
  return cells < kMinCells ? -1 : sum / cells;
}

bool FixedParts::Weigh(const Corners& corners, double stayed, const Frame& frame) {
  constexpr float kLeastChance = 0.05f, kMostChance = 0.95f;
  const auto found = static_cast<float>(settings_.found);
  const float common = std::clamp(static_cast<float>(stayed), kLeastChance, kMostChance);
  // The motion is needed only where the evidence would otherwise suffice.
  int close = 0;
  const float unproven = LogOdds(settings_.unproven), certain = LogOdds(settings_.certain);
  for (int y = 0; y < log_odds_.rows; ++y) {
    for (int x = 0; x < log_odds_.cols; ++x) {
      const float log_odds = log_odds_.at<float>(y, x);
      close += corners.stayed.at<uint8_t>(y, x) && log_odds < certain &&
               log_odds + std::log(found / common) > unproven;
    }
  }
  cv::Mat chance;
  const double scale = static_cast<double>(camera_.width) / then_.cols;
  const int cell = std::max(1, static_cast<int>(kShareCell / 2 * scale));
  if (close > 0.05 * settings_.least * static_cast<double>(log_odds_.total())) {
    chance = ChanceToStay(camera_, *frame_then_, frame, cell, kStays * scale);
    if (chance.empty()) return false;
  }
  for (int y = 0; y < log_odds_.rows; ++y) {
    for (int x = 0; x < log_odds_.cols; ++x) {
      if (!corners.is.at<uint8_t>(y, x)) continue;
      float scene = common;
      if (!chance.empty()) {
        scene = std::max(scene, chance.at<float>(static_cast<int>(y * scale) / cell,
                                                 static_cast<int>(x * scale) / cell));
        scene = std::min(scene, kMostChance);
      }
      float& log_odds = log_odds_.at<float>(y, x);
      const float before = log_odds;
      log_odds += corners.stayed.at<uint8_t>(y, x)
                      ? std::log(found / scene)
                      : std::log((1 - found) / (1 - std::min(scene, found)));
      const float most = chance.empty() ? std::max(before, unproven) : kLimit;
      log_odds = std::clamp(log_odds, -kLimit, most);
    }
  }
  return true;
}

// Updates the mask; true if it has a part now that was not known before.
bool FixedParts::Decide() {
  cv::Mat certain;
  cv::compare(log_odds_, LogOdds(settings_.certain), certain, cv::CMP_GT);
  const auto square = [](int half) {
    return cv::getStructuringElement(cv::MORPH_RECT, {2 * half + 1, 2 * half + 1});
  };
  cv::dilate(certain, certain, square(2 * kRim));
  cv::erode(certain, certain, square(kRim));
  const double share =
      static_cast<double>(cv::countNonZero(certain)) / static_cast<double>(certain.total());
  const bool whole = share < kGrows * candidates_;
  candidates_ = share;
  if (share < settings_.least) {
    mask_ = cv::Mat();
    share_ = 0;
    return false;
  }
  if (told_ == 0 && !whole) return false;
  const bool more = whole && share > kGrows * told_;
  if (more) told_ = share;
  mask_ = certain;
  share_ = share;
  return more;
}

}  // namespace alidade
