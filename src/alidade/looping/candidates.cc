#include "alidade/looping/candidates.h"

#include <algorithm>

#include "alidade/base/id_map.h"

namespace alidade {
namespace {

bool AreCovisible(const KeyFrame& keyframe, KeyFrameId other) {
  return std::any_of(keyframe.covisible.begin(), keyframe.covisible.end(),
                     [&](const Neighbour& n) { return n.id == other; });
}

// What mapping ties together anyway.
IdSet<KeyFrameId> Surroundings(const MapSnapshot& map, const KeyFrame& keyframe) {
  IdSet<KeyFrameId> near;
  near.Enter(keyframe.id);
  for (const Neighbour& n : keyframe.covisible) {
    near.Enter(n.id);
    for (const Neighbour& second : map.Find(n.id)->covisible) near.Enter(second.id);
  }
  return near;
}

}  // namespace

std::vector<KeyFrameId> FindLoopCandidates(const MapSnapshot& map, const PlaceIndex& places,
                                           KeyFrameId id, const LoopSettings& settings,
                                           const std::function<bool(KeyFrameId)>& may_be) {
  const KeyFrame& keyframe = *map.Find(id);
  const IdSet<KeyFrameId> near = Surroundings(map, keyframe);
  std::vector<KeyFrameId> neighbours;
  for (const Neighbour& n : keyframe.covisible) neighbours.push_back(n.id);
  double likest = 0;
  for (double score : places.Scores(*keyframe.frame, neighbours)) likest = std::max(likest, score);
  std::vector<KeyFrameId> chosen;
  int in_this_map = 0, in_others = 0;
  const auto lives_afar = [&](KeyFrameId other) {
    return !near.Contains(other) && map.Find(other) && (!may_be || may_be(other));
  };
  for (const PlaceMatch& match :
       places.Query(*keyframe.frame, lives_afar, static_cast<size_t>(settings.group))) {
    if (match.score < settings.score_share * likest) break;
    const KeyFrame& other = *map.Find(match.id);
    int& count = other.map == keyframe.map ? in_this_map : in_others;
    if (count >= settings.candidates) continue;
    const bool grouped = std::any_of(chosen.begin(), chosen.end(), [&](KeyFrameId better) {
      return AreCovisible(other, better);
    });
    if (grouped) continue;
    chosen.push_back(match.id);
    ++count;
  }
  return chosen;
}

}  // namespace alidade
