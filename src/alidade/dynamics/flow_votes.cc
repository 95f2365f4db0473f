#include "alidade/dynamics/flow_votes.h"

#include <algorithm>
#include <cmath>

#include "alidade/dynamics/evidence.h"
#include "alidade/geometry/two_view_ransac.h"

namespace alidade {
namespace {

// `off`: distance from the predicted segment, pixels; `way`: length of the motion in the image,
// pixels.
int8_t Vote(double off, double way, bool measured, const FlowVoteSettings& settings) {
  const double moved = measured ? settings.measured_px + settings.measured_share * way
                                : settings.moved_px + settings.moved_share * way;
  return off > moved ? -1 : off < moved / 2 ? 1 : 0;
}

struct InverseDepths {
  double least = 0, most = 0;  // 1/meters
  bool measured = false;       // from a measured depth
};

// Range of the point's possible depths in the earlier view: the extremes of the neighboring cells,
// because corners often lie on an outline, widened by depth_noise.
InverseDepths MayHave(const Cells& cells, const PastView& past, cv::Point2f then, double nearest,
                      const FlowVoteSettings& settings) {
  const int cell = cells.At(then.x, then.y);
  if (past.depth.empty() || !(past.depth[cell] > 0)) return {0, 1 / nearest, false};
  float near = past.depth[cell], far = near;
  cells.VisitAround(cell, 1, [&](int n) {
    if (!(past.depth[n] > 0)) return;
    near = std::min(near, past.depth[n]);
    far = std::max(far, past.depth[n]);
  });
  return {1 / ((1 + settings.depth_noise) * far), 1 / ((1 - settings.depth_noise) * near), true};
}

}  // namespace

std::vector<int8_t> VoteByPose(const Camera& camera, const Cells& cells,
                               std::span<const FlowTrack> tracks, const Se3& T_camera_world,
                               const History& history, double nearest,
                               const FlowVoteSettings& settings) {
  std::vector<int8_t> votes(tracks.size(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const FlowTrack& track = tracks[i];
    // Use the oldest frame of the track that has a pose, for the largest parallax.
    int ago = std::min(track.length() - 1, settings.most_ago);
    while (ago >= settings.least_ago && !history.Before(ago)) --ago;
    if (ago < settings.least_ago) continue;
    const PastView& past = *history.Before(ago);
    const cv::Point2f then = track.Before(ago);
    const Eigen::Vector2d pixel_then = camera.Undistort({then.x, then.y});
    const Eigen::Vector2d pixel_now = camera.Undistort({track.at().x, track.at().y});
    const InverseDepths range = MayHave(cells, past, then, nearest, settings);
    const EpipolarSegment segment =
        SegmentOf(camera, camera.Unproject(pixel_then),
                  T_camera_world * past.T_camera_world.Inverse(), range.least, range.most);
    votes[i] = segment.in_front ? Vote(DistanceTo(segment, pixel_now),
                                       (pixel_now - pixel_then).norm(), range.measured, settings)
                                : int8_t{-1};
  }
  return votes;
}

std::vector<int8_t> VoteByAgreement(const Camera& camera, std::span<const FlowTrack> tracks,
                                    std::span<const uint8_t> left_out, uint64_t seed,
                                    const FlowVoteSettings& settings) {
  const int ago = settings.agreement_ago;
  const double sigma = settings.agreement_sigma;
  std::vector<int8_t> votes(tracks.size(), 0);
  std::vector<Eigen::Vector2d> a, b;
  std::vector<size_t> used;
  const Eigen::Vector2d middle(camera.cx, camera.cy);
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].length() <= ago || left_out[i]) continue;
    const cv::Point2f then = tracks[i].Before(ago), now = tracks[i].at();
    a.push_back((camera.Undistort({then.x, then.y}) - middle) / sigma);
    b.push_back((camera.Undistort({now.x, now.y}) - middle) / sigma);
    used.push_back(i);
  }
  if (used.size() < static_cast<size_t>(settings.agreement_tracks)) return votes;
  const RansacModels models = FitTwoViewModels(a, b, settings.agreement_iterations, seed, false);
  const bool turned =
      models.homography.inliers > settings.homography_share * models.fundamental.inliers;
  const RansacModel& model = turned ? models.homography : models.fundamental;
  if (model.inliers < settings.agreement_share * static_cast<double>(used.size())) return votes;
  for (size_t k = 0; k < used.size(); ++k) votes[used[k]] = model.inlier[k] ? 1 : -1;
  return votes;
}

double ShareOfRivalMotion(const Camera& camera, const Cells& cells,
                          std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                          uint64_t seed, const FlowVoteSettings& settings) {
  const int block = settings.rival_block;
  std::vector<uint8_t> fits(tracks.size());
  for (size_t i = 0; i < tracks.size(); ++i) fits[i] = votes[i] >= 0;
  const std::vector<int8_t> rival = VoteByAgreement(camera, tracks, fits, seed, settings);
  const int columns = cells.columns() / block + 1, rows = cells.rows() / block + 1;
  std::vector<int> sums(static_cast<size_t>(columns * rows), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const int cell = cells.At(tracks[i].at().x, tracks[i].at().y);
    const int row = cell / cells.columns() / block, column = cell % cells.columns() / block;
    sums[row * columns + column] += votes[i] > 0 ? 1 : rival[i] > 0 ? -1 : 0;
  }
  const auto rivals = std::count_if(sums.begin(), sums.end(), [](int sum) { return sum < 0; });
  const auto fitting = std::count_if(sums.begin(), sums.end(), [](int sum) { return sum > 0; });
  if (rivals + fitting < settings.rival_blocks) return 0;
  return static_cast<double>(rivals) / static_cast<double>(rivals + fitting);
}

std::vector<int8_t> Consensus(const Cells& cells, std::span<const float> depth,
                              std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                              const FlowVoteSettings& settings,
                              const CellDepthSettings& depth_settings) {
  std::vector<int> sums(cells.count(), 0), counts(cells.count(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const int cell = cells.At(tracks[i].at().x, tracks[i].at().y);
    sums[cell] += votes[i];
    ++counts[cell];
  }
  std::vector<int8_t> agreed(tracks.size(), 0);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const int cell = cells.At(tracks[i].at().x, tracks[i].at().y);
    int sum = 0, count = 0;
    cells.VisitAround(cell, settings.consensus_reach, [&](int n) {
      if (ApartInDepth(depth, cell, n, depth_settings)) return;
      sum += sums[n];
      count += counts[n];
    });
    if (count < settings.consensus_tracks) continue;
    const float mean = static_cast<float>(sum) / static_cast<float>(count);
    agreed[i] = mean < -settings.consensus ? -1 : mean > settings.consensus ? 1 : 0;
  }
  return agreed;
}

}  // namespace alidade
