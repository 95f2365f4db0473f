#include "alidade/looping/candidates.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/id_map.h"
#include "alidade/looping/surroundings.h"

namespace alidade {
namespace {

bool AreCovisible(const KeyFrame& keyframe, KeyFrameId other) {
  return std::any_of(keyframe.covisible.begin(), keyframe.covisible.end(),
                     [&](const Neighbour& n) { return n.id == other; });
}

// Keyframes that local mapping already connects: covisible ones with at least `tied_share` of the
// keyframe's landmarks, and theirs. Fewer shared landmarks may all be distant ones (the far end of
// a corridor), which constrain neither translation nor scale.
IdSet<KeyFrameId> Surroundings(const MapSnapshot& map, const KeyFrame& keyframe,
                               double tied_share) {
  IdSet<KeyFrameId> near;
  near.Enter(keyframe.id);
  for (KeyFrameId id : TiedTo(keyframe, tied_share)) {
    near.Enter(id);
    for (KeyFrameId second : TiedTo(*map.Find(id), tied_share)) near.Enter(second);
  }
  return near;
}

// Angle between the optical axes, radians.
double AngleOfViews(const KeyFrame& a, const KeyFrame& b) {
  const Eigen::Vector3d of_a = a.T_camera_world.R.row(2), of_b = b.T_camera_world.R.row(2);
  return std::atan2(of_a.cross(of_b).norm(), of_a.dot(of_b));
}

}  // namespace

std::vector<KeyFrameId> FindLoopCandidates(const MapSnapshot& map, const PlaceIndex& places,
                                           KeyFrameId id, const LoopSettings& settings,
                                           const std::function<bool(KeyFrameId)>& may_be) {
  const KeyFrame& keyframe = *map.Find(id);
  const IdSet<KeyFrameId> near = Surroundings(map, keyframe, settings.tied_share);
  std::vector<KeyFrameId> neighbours;
  for (const Neighbour& n : keyframe.covisible) neighbours.push_back(n.id);
  double likest = 0;
  for (double score : places.Scores(*keyframe.frame, neighbours)) likest = std::max(likest, score);
  std::vector<KeyFrameId> chosen;
  int in_this_map = 0, in_others = 0;
  const auto lives_afar = [&](KeyFrameId id_of_other) {
    const KeyFrame* other = map.Find(id_of_other);
    return other && !near.Contains(id_of_other) && (!may_be || may_be(id_of_other)) &&
           (other->map != keyframe.map || AngleOfViews(keyframe, *other) < settings.max_view_turn);
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
