#include "alidade/map/correction.h"

#include <algorithm>
#include <optional>

namespace alidade {
namespace {

struct Move {
  Se3 T_old;  // T_camera_world before
  Se3 T_new;  // and after
  double growth = 1;
};

}  // namespace

void CommitCorrections(MapCommit& commit, const std::vector<KeyFrameCorrection>& corrections) {
  std::vector<std::optional<Move>> moves(commit.next_keyframe());
  auto next = corrections.begin();
  for (uint32_t i = 0; i < commit.next_keyframe(); ++i) {  // parents come before their children
    while (next != corrections.end() && next->id.value < i) ++next;
    const KeyFrame* keyframe = commit.Find(KeyFrameId{i});
    if (!keyframe) continue;
    if (next != corrections.end() && next->id.value == i) {
      moves[i] = Move{keyframe->T_camera_world, next->T_camera_world, next->growth};
    } else if (keyframe->parent.valid() && moves[keyframe->parent.value]) {
      const Move& parent = *moves[keyframe->parent.value];
      Se3 T_here_parent = keyframe->T_camera_world * parent.T_old.Inverse();
      T_here_parent.t *= parent.growth;
      moves[i] = Move{keyframe->T_camera_world, T_here_parent * parent.T_new, parent.growth};
    }
    if (!moves[i]) continue;
    KeyFrame* edited = commit.Edit(KeyFrameId{i});
    edited->T_camera_world = moves[i]->T_new.Normalised();
    edited->scale *= moves[i]->growth;
  }
  for (uint32_t i = 0; i < commit.next_landmark(); ++i) {
    const Landmark* landmark = commit.Find(LandmarkId{i});
    if (!landmark || !moves[landmark->reference.value]) continue;
    const Move& move = *moves[landmark->reference.value];
    const Se3 T_world_camera = move.T_new.Inverse();
    Landmark* edited = commit.Edit(LandmarkId{i});
    edited->p_world = T_world_camera * (move.growth * (move.T_old * edited->p_world));
    edited->normal = (T_world_camera.R * move.T_old.R).cast<float>() * edited->normal;
    edited->min_distance *= static_cast<float>(move.growth);
    edited->max_distance *= static_cast<float>(move.growth);
  }
  commit.CountCorrection();
}

void CommitMerge(MapCommit& commit, MapId younger, MapId older, const Sim3& T_older_younger,
                 KeyFrameId anchor) {
  std::vector<KeyFrameCorrection> corrections;
  for (uint32_t i = 0; i < commit.next_keyframe(); ++i) {
    const KeyFrame* keyframe = commit.Find(KeyFrameId{i});
    if (!keyframe || keyframe->map != younger) continue;
    Se3 T;  // the camera stays where it is among its points
    T.R = keyframe->T_camera_world.R * T_older_younger.R.transpose();
    T.t = T_older_younger.s * keyframe->T_camera_world.t - T.R * T_older_younger.t;
    corrections.push_back({{i}, T, T_older_younger.s});
  }
  CommitCorrections(commit, corrections);
  for (const KeyFrameCorrection& moved : corrections) {
    KeyFrame* keyframe = commit.Edit(moved.id);
    keyframe->map = older;
    if (keyframe->parent.valid()) continue;
    while (anchor.valid() && anchor > keyframe->id) anchor = commit.Find(anchor)->parent;
    keyframe->parent = anchor;
  }
}

}  // namespace alidade
