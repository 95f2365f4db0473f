#include "alidade/io/ros/live/frame_gatherer.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace alidade {
namespace {

constexpr size_t kMostWaiting = 8;      // images, and partners
constexpr size_t kMostReadings = 5000;  // 5 s at 1 kHz without an image

double SecondsBetween(int64_t a, int64_t b) { return 1e-9 * static_cast<double>(a - b); }

}  // namespace

FrameGatherer::FrameGatherer(std::optional<double> max_dt, bool with_imu)
    : max_dt_(max_dt), with_imu_(with_imu) {}

void FrameGatherer::AddImage(StampedBytes image, double now) {
  images_.push_back({std::move(image), now});
  if (images_.size() > kMostWaiting) images_.pop_front();
}

void FrameGatherer::AddPartner(StampedBytes partner) {
  partners_.push_back(std::move(partner));
  if (partners_.size() > kMostWaiting) partners_.pop_front();
}

void FrameGatherer::AddImu(const ImuSample& sample) {
  imu_.push_back(sample);
  if (imu_.size() > kMostReadings) imu_.erase(imu_.begin(), imu_.begin() + kMostReadings / 2);
}

int FrameGatherer::PartnerOf(const StampedBytes& image) const {
  int best = -1;
  double best_dt = *max_dt_;
  for (size_t i = 0; i < partners_.size(); ++i) {
    const double dt = std::abs(SecondsBetween(partners_[i].stamp, image.stamp));
    if (dt > best_dt) continue;
    best = static_cast<int>(i);
    best_dt = dt;
  }
  return best;
}

bool FrameGatherer::HasReadings(const StampedBytes& image) const {
  return !imu_.empty() && imu_.back().time >= 1e-9 * static_cast<double>(image.stamp);
}

std::optional<GatheredFrame> FrameGatherer::Take(double now) {
  for (size_t i = images_.size(); i-- > 0;) {
    const Waiting& waiting = images_[i];
    const int partner = max_dt_ ? PartnerOf(waiting.image) : -1;
    const bool complete = (!max_dt_ || partner >= 0) && (!with_imu_ || HasReadings(waiting.image));
    if (!complete && now - waiting.since < kLongestWait) continue;
    GatheredFrame frame;
    frame.image = std::move(images_[i].image);
    const auto end = [](auto& all, size_t n) {
      return all.begin() + static_cast<std::ptrdiff_t>(n);
    };
    images_.erase(images_.begin(), end(images_, i + 1));
    if (partner >= 0) {
      const auto n = static_cast<size_t>(partner);
      frame.partner = std::move(partners_[n]);
      partners_.erase(partners_.begin(), end(partners_, n + 1));
    }
    frame.imu = std::exchange(imu_, {});
    return frame;
  }
  return std::nullopt;
}

}  // namespace alidade
