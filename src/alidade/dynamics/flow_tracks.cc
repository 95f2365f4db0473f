#include "alidade/dynamics/flow_tracks.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "alidade/base/parallel.h"
#include "alidade/features/fast.h"
#include "alidade/features/mask.h"

namespace alidade {
namespace {

// Flow at half resolution suffices to detect moving objects and takes a quarter of the time.
constexpr int kShrink = 2;
constexpr int kLevels = 3;
const cv::Size kWindow(9, 9);    // pixels of the half-size image
constexpr float kReturn = 0.5f;  // pixels there: largest forward-backward error of a track
constexpr int kCell = 27;        // pixels: side of the cells in which new tracks are started
constexpr int kPerCell = 1;
constexpr double kCut = 0.2;  // share of the tracks: when fewer survive, assume a cut
constexpr int kMost = 500;
constexpr int kChunk = 64;  // tracks per parallel task

}  // namespace

void FlowTracks::Advance(const cv::Mat& gray) {
  cv::Mat small;
  cv::resize(gray, small, {gray.cols / kShrink, gray.rows / kShrink}, 0, 0, cv::INTER_AREA);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(small, pyramid, kWindow, kLevels);
  ++frames_;
  if (!tracks_.empty() && !pyramid_.empty()) {
    std::vector<cv::Point2f> before, now, back;
    for (const FlowTrack& track : tracks_) {
      before.push_back(track.at() / kShrink);
      const bool moves = track.length() > 1;  // predict by the previous motion
      now.push_back(before.back() +
                    (moves ? (track.at() - track.Before(1)) / kShrink : cv::Point2f()));
    }
    back = before;
    std::vector<uint8_t> found, found_back;
    const int count = static_cast<int>(before.size());
    found.resize(before.size());
    found_back.resize(before.size());
    ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
      const int first = chunk * kChunk, size = std::min(kChunk, count - first);
      const auto part = [&](std::vector<cv::Point2f>& points) {
        return cv::Mat(size, 1, CV_32FC2, points.data() + first);
      };
      const auto flags = [&](std::vector<uint8_t>& of) {
        return cv::Mat(size, 1, CV_8U, of.data() + first);
      };
      const cv::TermCriteria enough(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 10, 0.03);
      cv::Mat p_before = part(before), p_now = part(now), p_back = part(back);
      cv::Mat f_now = flags(found), f_back = flags(found_back);
      cv::calcOpticalFlowPyrLK(pyramid_, pyramid, p_before, p_now, f_now, cv::noArray(), kWindow,
                               kLevels, enough, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
      cv::calcOpticalFlowPyrLK(pyramid, pyramid_, p_now, p_back, f_back, cv::noArray(), kWindow, 0,
                               enough, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
    });
    std::vector<FlowTrack> kept;
    for (size_t i = 0; i < tracks_.size(); ++i) {
      const cv::Point2f p = now[i] * kShrink, astray = back[i] - before[i];
      if (!found[i] || !found_back[i] || std::hypot(astray.x, astray.y) > kReturn) continue;
      if (!(p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(gray.cols - 1) &&
            p.y <= static_cast<float>(gray.rows - 1)))
        continue;
      FlowTrack& track = tracks_[i];
      track.path.push_back(p);
      if (track.length() > kHistory) track.path.pop_front();
      kept.push_back(std::move(track));
    }
    // After a cut a few tracks match by chance.
    if (static_cast<double>(kept.size()) < kCut * count) kept.clear();
    tracks_ = std::move(kept);
  }
  pyramid_ = std::move(pyramid);
}

void FlowTracks::SeedCorners(const cv::Mat& left_out, const Camera& camera) {
  constexpr int kThreshold = 12;  // gray levels, of the half-size image
  constexpr int kBorder = 18;     // pixels of it: the least that FastCorners() admits
  const cv::Mat& image = pyramid_.front();
  std::vector<Corner> corners =
      FastCorners(image, kThreshold, kBorder, kBorder, image.rows - kBorder);
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.score > b.score; });
  std::vector<Keypoint> keypoints;
  for (const Corner& corner : corners) {
    Keypoint keypoint;
    keypoint.raw_x = static_cast<float>(kShrink * corner.x);
    keypoint.raw_y = static_cast<float>(kShrink * corner.y);
    if (!Marks(left_out, keypoint.raw_x, keypoint.raw_y, camera)) keypoints.push_back(keypoint);
  }
  Seed(keypoints, {camera.width, camera.height});
}

void FlowTracks::Seed(std::span<const Keypoint> keypoints, cv::Size image) {
  const int columns = image.width / kCell + 1, rows = image.height / kCell + 1;
  std::vector<uint8_t> count(static_cast<size_t>(columns) * rows, 0);
  const auto cell = [&](cv::Point2f p) -> uint8_t& {
    return count[static_cast<size_t>(p.y / kCell) * columns + static_cast<size_t>(p.x / kCell)];
  };
  for (const FlowTrack& track : tracks_) ++cell(track.at());
  for (const Keypoint& keypoint : keypoints) {
    if (tracks_.size() >= kMost) break;
    if (keypoint.level > 2) continue;
    const cv::Point2f p(keypoint.raw_x, keypoint.raw_y);
    if (cell(p) >= kPerCell) continue;
    ++cell(p);
    FlowTrack track;
    track.id = next_id_++;
    track.first = frames_;
    track.path = {p};
    tracks_.push_back(std::move(track));
  }
}

}  // namespace alidade
