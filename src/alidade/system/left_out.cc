#include "alidade/system/left_out.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "alidade/base/log.h"
#include "alidade/base/part_times.h"
#include "alidade/features/mask.h"
#include "alidade/features/subset.h"

namespace alidade {
namespace {

// Of the larger of the two sizes; either may be empty.
cv::Mat Union(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || b.empty()) return a.empty() ? b : a;
  const cv::Mat& larger = a.total() >= b.total() ? a : b;
  cv::Mat other, both;
  cv::resize(&larger == &a ? b : a, other, larger.size(), 0, 0, cv::INTER_NEAREST);
  cv::bitwise_or(larger, other, both);
  return both;
}

constexpr double kLeastMore = 0.005;  // share of the image: less is the rim of what is known

double ShareOf(const cv::Mat& mask) {
  return mask.empty() ? 0 : cv::countNonZero(mask) / static_cast<double>(mask.total());
}

}  // namespace

void LeftOut::Name(const cv::Mat& mask) {
  cv::compare(mask, 0, named_, cv::CMP_NE);
  if (named_.total() > static_cast<size_t>(size_.area()))
    cv::resize(named_, named_, size_, 0, 0, cv::INTER_NEAREST);
  Update();
}

void LeftOut::Update() {
  all_ = Union(named_, fixed_.mask());
  share_ = ShareOf(all_);
}

bool LeftOut::See(const cv::Mat& image, const std::shared_ptr<const Frame>& frame) {
  const PartTimer timer(FramePart::kLeftOut);
  if (!look_) return false;
  const cv::Mat known = fixed_.mask();
  const bool found = fixed_.See(image, frame);
  if (fixed_.mask().data == known.data) return false;
  const double before = share_;
  Update();
  const bool more = found && share_ > before + kLeastMore;  // else it was named
  if (more) {
    LogWarning(std::to_string(std::lround(100 * fixed_.share())) +
               " % of the image moves with the camera (a hood, a hand, a caption): left out from "
               "now on");
  }
  return more;
}

cv::Mat LeftOut::With(const cv::Mat& movers) const { return Union(all_, movers); }

void LeftOut::RemoveFrom(Frame& frame, const Camera& camera) const {
  const PartTimer timer(FramePart::kLeftOut);
  if (all_.empty()) return;
  std::vector<int> kept;
  for (int k = 0; k < static_cast<int>(frame.keypoints.size()); ++k) {
    const Keypoint& keypoint = frame.keypoints[k];
    if (!Marks(all_, keypoint.raw_x, keypoint.raw_y, camera)) kept.push_back(k);
  }
  const cv::Mat glance = frame.glance;
  if (kept.size() < frame.keypoints.size()) frame = KeypointSubset(frame, kept, camera);
  if (!glance.empty()) {
    cv::Mat marked;
    cv::resize(all_, marked, glance.size(), 0, 0, cv::INTER_NEAREST);
    frame.glance = glance.clone();
    frame.glance.setTo(std::numeric_limits<float>::quiet_NaN(), marked);
  }
  if (frame.picture) {
    cv::Mat marked;
    cv::resize(all_, marked, frame.picture->gray.size(), 0, 0, cv::INTER_NEAREST);
    auto picture = std::make_shared<Picture>(*frame.picture);
    picture->mask = Union(marked, picture->mask);
    frame.picture = std::move(picture);
  }
}

}  // namespace alidade
