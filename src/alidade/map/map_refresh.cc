// Data derived from observations: search data of landmarks, covisibility of keyframes.
#include <algorithm>
#include <limits>

#include "alidade/base/id_map.h"
#include "alidade/map/map_store.h"

namespace alidade {
namespace {

// Landmarks that two keyframes must share to be covisible (Mur-Artal, Montiel & Tardós 2015,
// §III-D).
constexpr int kMinShared = 15;

bool MoreShared(const Neighbour& a, const Neighbour& b) {
  return a.shared != b.shared ? a.shared > b.shared : a.id < b.id;
}

// Index of the descriptor with the smallest median distance to all of them; the first of several.
size_t Representative(const std::vector<const Descriptor*>& descriptors) {
  const size_t count = descriptors.size();
  if (count <= 2) return 0;
  std::vector<int> distances(count * count);
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < i; ++j) {
      distances[i * count + j] = distances[j * count + i] =
          HammingDistance(*descriptors[i], *descriptors[j]);
    }
  }
  size_t best = 0;
  int best_median = std::numeric_limits<int>::max();
  const auto middle = static_cast<std::ptrdiff_t>((count - 1) / 2);
  for (size_t i = 0; i < count; ++i) {
    const auto row = distances.begin() + static_cast<std::ptrdiff_t>(i * count);
    const auto end = row + static_cast<std::ptrdiff_t>(count);
    // The median is smaller only if more distances than `middle` are.
    if (std::count_if(row, end, [&](int d) { return d < best_median; }) <= middle) continue;
    std::nth_element(row, row + middle, end);
    best_median = row[middle];
    best = i;
  }
  return best;
}

}  // namespace

void MapCommit::RefreshLandmark(LandmarkId id) {
  Landmark* landmark = Edit(id);
  if (!landmark) return;
  if (landmark->observations.empty()) return Remove(id);

  std::vector<const Descriptor*> descriptors;
  descriptors.reserve(landmark->observations.size());
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const Observation& seen : landmark->observations) {
    const KeyFrame* keyframe = Find(seen.keyframe);
    descriptors.push_back(&keyframe->frame->descriptors[seen.keypoint]);
    direction += (landmark->p_world - keyframe->Centre()).normalized();
  }
  landmark->descriptor = *descriptors[Representative(descriptors)];
  landmark->normal = direction.normalized().cast<float>();

  const KeyFrame* reference = Find(landmark->reference);
  const auto seen =
      std::find_if(landmark->observations.begin(), landmark->observations.end(),
                   [&](const Observation& o) { return o.keyframe == landmark->reference; });
  const int level = reference->frame->keypoints[seen->keypoint].level;
  const double distance = (landmark->p_world - reference->Centre()).norm();
  landmark->max_distance = static_cast<float>(distance * ScaleOfLevel(level));
  landmark->min_distance =
      static_cast<float>(distance * ScaleOfLevel(level) / ScaleOfLevel(kPyramidLevels - 1));
}

void MapCommit::RefreshCovisibility(KeyFrameId id) {
  KeyFrame* keyframe = Edit(id);
  if (!keyframe) return;
  IdMap<KeyFrameId, int> shared;
  for (LandmarkId landmark_id : keyframe->landmarks) {
    const Landmark* landmark = landmark_id.valid() ? Find(landmark_id) : nullptr;
    if (!landmark) continue;
    for (const Observation& seen : landmark->observations) ++shared[seen.keyframe];
  }
  std::vector<Neighbour> neighbours;
  Neighbour best;
  for (const auto& [other, count] : shared.entries()) {
    if (other == id) continue;
    const Neighbour neighbour{other, count};
    if (count >= kMinShared) neighbours.push_back(neighbour);
    if (MoreShared(neighbour, best)) best = neighbour;
  }
  if (neighbours.empty() && best.shared > 0) neighbours.push_back(best);
  std::sort(neighbours.begin(), neighbours.end(), MoreShared);

  const auto enter = [&](KeyFrameId other_id, int count) {
    KeyFrame* other = Edit(other_id);
    if (!other) return;
    std::erase_if(other->covisible, [&](const Neighbour& n) { return n.id == id; });
    if (count == 0) return;
    const Neighbour entry{id, count};
    other->covisible.insert(
        std::upper_bound(other->covisible.begin(), other->covisible.end(), entry, MoreShared),
        entry);
  };
  for (const Neighbour& old : keyframe->covisible) {
    const bool still = std::any_of(neighbours.begin(), neighbours.end(),
                                   [&](const Neighbour& n) { return n.id == old.id; });
    if (!still) enter(old.id, 0);
  }
  for (const Neighbour& neighbour : neighbours) enter(neighbour.id, neighbour.shared);
  keyframe->covisible = std::move(neighbours);
}

}  // namespace alidade
