#include "alidade/map/correction.h"

#include <utility>

#include "alidade/base/id_map.h"

namespace alidade {
namespace {

struct Move {
  Se3 T_old;  // T_camera_world before
  Se3 T_new;  // T_camera_world after
  double growth = 1;
};

void KeepWorldOf(MapCommit& commit, MapId older, MapId younger,
                 const Eigen::Matrix3d& R_older_younger) {
  const MapWorld* gone = FindWorld(commit.state().worlds, younger);
  const MapWorld* kept = FindWorld(commit.state().worlds, older);
  if (gone && gone->KnowsDown() && !(kept && kept->KnowsDown())) {
    MapWorld world = kept ? *kept : MapWorld{};
    world.map = older;
    world.down = (R_older_younger * gone->down).normalized();
    world.down_sigma = gone->down_sigma;
    commit.SetWorld(world);
  }
  commit.ForgetWorld(younger);
}

}  // namespace

void CommitCorrections(MapCommit& commit, const std::vector<KeyFrameCorrection>& corrections) {
  IdMap<KeyFrameId, Move> moves;
  auto next = corrections.begin();
  commit.state().keyframes.ForEach([&](const KeyFrame& keyframe) {  // parents come first
    while (next != corrections.end() && next->id < keyframe.id) ++next;
    if (next != corrections.end() && next->id == keyframe.id) {
      moves[keyframe.id] = {keyframe.T_camera_world, next->T_camera_world, next->growth};
    } else if (const Move* parent = moves.Find(keyframe.parent)) {
      Se3 T_here_parent = keyframe.T_camera_world * parent->T_old.Inverse();
      T_here_parent.t *= parent->growth;
      const Move move{keyframe.T_camera_world, T_here_parent * parent->T_new, parent->growth};
      moves[keyframe.id] = move;
    }
  });
  for (const auto& [id, move] : moves.entries()) {
    KeyFrame* edited = commit.Edit(id);
    edited->T_camera_world = move.T_new.Normalised();
    edited->scale *= move.growth;
    edited->covariance.topRows<3>() *= move.growth;
    edited->covariance.leftCols<3>() *= move.growth;
  }
  std::vector<std::pair<LandmarkId, Move>> moved;
  commit.state().landmarks.ForEach([&](const Landmark& landmark) {
    if (const Move* move = moves.Find(landmark.reference)) moved.push_back({landmark.id, *move});
  });
  for (const auto& [id, move] : moved) {
    const Se3 T_world_camera = move.T_new.Inverse();
    Landmark* edited = commit.Edit(id);
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
  commit.state().keyframes.ForEach([&](const KeyFrame& keyframe) {
    if (keyframe.map != younger) return;
    Se3 T;  // keep the camera's position relative to its points
    T.R = keyframe.T_camera_world.R * T_older_younger.R.transpose();
    T.t = T_older_younger.s * keyframe.T_camera_world.t - T.R * T_older_younger.t;
    corrections.push_back({keyframe.id, T, T_older_younger.s});
  });
  CommitCorrections(commit, corrections);
  for (const KeyFrameCorrection& moved : corrections) {
    KeyFrame* keyframe = commit.Edit(moved.id);
    keyframe->map = older;
    if (keyframe->parent.valid()) continue;
    while (anchor.valid() && anchor > keyframe->id) anchor = commit.Find(anchor)->parent;
    keyframe->parent = anchor;
  }
  KeepWorldOf(commit, older, younger, T_older_younger.R);
}

}  // namespace alidade
