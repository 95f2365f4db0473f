#include "alidade/optimize/bundle_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "alidade/base/error.h"

namespace alidade {
namespace {

// Enough for a few threads; each chunk needs its own copy of the reduced system.
constexpr int kMaxChunks = 4;
constexpr int kSightingsPerChunk = 1000;

void CheckProblem(const BundleProblem& problem) {
  const int cameras = static_cast<int>(problem.T_camera_world.size());
  const int points = static_cast<int>(problem.points.size());
  if (problem.fixed.size() != problem.T_camera_world.size()) {
    ThrowUsage("bundle problem: one `fixed` for each camera is needed");
  }
  for (size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& o = problem.observations[i];
    if (o.camera < 0 || o.camera >= cameras || o.point < 0 || o.point >= points) {
      ThrowUsage("bundle problem: observation " + std::to_string(i) +
                 " names a camera or point that is not there");
    }
  }
}

bool Usable(const BundleProblem& problem, const BundleObservation& o) {
  const Se3& T = problem.T_camera_world[o.camera];
  const Eigen::Vector3d& p_world = problem.points[o.point];
  return o.pixel.head<2>().allFinite() && o.inv_sigma2 > 0 && std::isfinite(o.inv_sigma2) &&
         o.trust > 0 && p_world.allFinite() && T.R.allFinite() && T.t.allFinite() &&
         T.R.row(2).dot(p_world) + T.t.z() > kMinDepth;
}

BundleSighting Sight(const Intrinsics& k, const BundleObservation& o, int slot,
                     const BundleSettings& settings) {
  const bool stereo =
      HasRight(k, o.pixel.z()) && o.inv_sigma2_right > 0 && std::isfinite(o.inv_sigma2_right);
  BundleSighting s;
  s.camera = o.camera;
  s.slot = slot;
  s.u = o.pixel.x();
  s.v = o.pixel.y();
  s.right = stereo ? o.pixel.z() : 0;
  s.weight = o.inv_sigma2;
  s.weight_r = stereo ? o.inv_sigma2_right : 0;
  const double bound = stereo ? settings.huber_stereo : settings.huber_mono;
  s.huber = settings.redescending ? std::numeric_limits<double>::infinity() : bound;
  s.inv_c2 = settings.redescending ? 1 / (bound * bound) : 0;
  s.trust = o.trust;
  return s;
}

// By insertion, which is stable: few sightings, and mostly in order already.
void SortBySlot(std::vector<BundleSighting>::iterator first,
                std::vector<BundleSighting>::iterator last) {
  for (auto next = first; next != last; ++next) {
    const BundleSighting sighting = *next;
    auto to = next;
    for (; to != first && sighting.slot < to[-1].slot; --to) *to = to[-1];
    *to = sighting;
  }
}

std::vector<int> Cut(const BundleLayout& layout) {
  const int total = static_cast<int>(layout.sightings.size());
  const int count = std::clamp(total / kSightingsPerChunk, 1, kMaxChunks);
  std::vector<int> chunks{0};
  for (int i = 0; i < static_cast<int>(layout.points.size()); ++i) {
    const int64_t target =
        static_cast<int64_t>(total) * static_cast<int64_t>(chunks.size()) / count;
    if (layout.points[i].begin >= target) chunks.push_back(i);
  }
  chunks.push_back(static_cast<int>(layout.points.size()));
  return chunks;
}

}  // namespace

BundleLayout LayOut(const BundleProblem& problem, const BundleSettings& settings) {
  CheckProblem(problem);
  BundleLayout layout;
  layout.intrinsics = Intrinsics::Of(problem.camera);

  // Counting sort by point, free cameras before fixed ones: accepts any order and keeps it among
  // those of a kind.
  std::vector<int> start(problem.points.size() + 1, 0), free(problem.points.size(), 0);
  std::vector<uint8_t> usable(problem.observations.size());
  std::vector<int> slot(problem.T_camera_world.size(), -1);
  for (size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& o = problem.observations[i];
    usable[i] = Usable(problem, o);
    if (!usable[i]) continue;
    ++start[o.point + 1];
    if (problem.fixed[o.camera]) continue;
    ++free[o.point];
    slot[o.camera] = 0;
  }
  for (size_t c = 0; c < slot.size(); ++c) {
    if (slot[c] < 0) continue;
    slot[c] = static_cast<int>(layout.free_cameras.size());
    layout.free_cameras.push_back(static_cast<int>(c));
  }
  for (size_t p = 0; p < problem.points.size(); ++p) start[p + 1] += start[p];
  layout.sightings.resize(start.back());
  std::vector<int> next_free(start.begin(), start.end() - 1), next_fixed = next_free;
  for (size_t p = 0; p < free.size(); ++p) next_fixed[p] += free[p];
  for (size_t i = 0; i < problem.observations.size(); ++i) {
    if (!usable[i]) continue;
    const BundleObservation& o = problem.observations[i];
    int& next = (problem.fixed[o.camera] ? next_fixed : next_free)[o.point];
    layout.sightings[next++] = Sight(layout.intrinsics, o, slot[o.camera], settings);
  }

  for (size_t p = 0; p < problem.points.size(); ++p) {
    const int begin = start[p], end = start[p + 1];
    if (begin == end) continue;
    const auto first = layout.sightings.begin() + begin, last = first + free[p];
    SortBySlot(first, last);
    layout.points.push_back({static_cast<int>(p), begin, begin + free[p], end, layout.couplings});
    layout.couplings += free[p];
  }
  layout.chunks = Cut(layout);
  layout.motion = LayOutMotion(problem.motion, slot, static_cast<int>(layout.free_cameras.size()));
  return layout;
}

}  // namespace alidade
