#include "alidade/mapping/limit.h"

#include <queue>
#include <utility>

#include "alidade/base/id_map.h"

namespace alidade {
namespace {

// Weight of keyframes close to the camera; keyframes not listed have weight 1.
IdMap<KeyFrameId, double> Nearness(const MapSnapshot& map, KeyFrameId newest) {
  constexpr double kBeside = 4, kNextToThat = 2;
  IdMap<KeyFrameId, double> nearness;
  const KeyFrame* keyframe = map.Find(newest);
  if (!keyframe) return nearness;
  for (const Neighbour& near : keyframe->covisible) {
    for (const Neighbour& next : map.Find(near.id)->covisible) nearness[next.id] = kNextToThat;
  }
  for (const Neighbour& near : keyframe->covisible) nearness[near.id] = kBeside;
  return nearness;
}

}  // namespace

std::vector<KeyFrameId> FindLeastUseful(const MapSnapshot& map, KeyFrameId newest, int count) {
  const IdMap<KeyFrameId, double> nearness = Nearness(map, newest);
  IdMap<LandmarkId, int> lost;  // observations lost with the keyframes selected so far
  const auto worth = [&](const KeyFrame& keyframe) {
    double sum = 0;
    for (LandmarkId id : keyframe.landmarks) {
      const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
      if (!landmark) continue;
      const int* gone = lost.Find(id);
      sum += 1.0 / (static_cast<int>(landmark->observations.size()) - (gone ? *gone : 0));
    }
    const double age = static_cast<double>(newest.value - keyframe.id.value) / (newest.value + 1.0);
    const double* near = nearness.Find(keyframe.id);
    return sum * (1 - 0.5 * age) * (near ? *near : 1);
  };
  // Lazy evaluation: a selection can only raise the value of the others. If the reevaluated front
  // of the queue is still below the next entry, it is the minimum.
  using Entry = std::pair<double, KeyFrameId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    if (keyframe.parent.valid() && id < newest) queue.push({worth(keyframe), id});
  }
  std::vector<KeyFrameId> named;
  while (!queue.empty() && static_cast<int>(named.size()) < count) {
    const KeyFrame& keyframe = *map.Find(queue.top().second);
    queue.pop();
    const Entry now{worth(keyframe), keyframe.id};
    if (!queue.empty() && queue.top() < now) {
      queue.push(now);
      continue;
    }
    named.push_back(keyframe.id);
    for (LandmarkId id : keyframe.landmarks) {
      if (id.valid()) ++lost[id];
    }
  }
  return named;
}

}  // namespace alidade
