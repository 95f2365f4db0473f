#include "alidade/looping/close.h"

#include <algorithm>

#include "alidade/base/id_map.h"
#include "alidade/looping/surroundings.h"

namespace alidade {
namespace {

constexpr int kMinVotes = 15;  // landmarks that connect two keyframes

// A keyframe of the window with its pose according to the match.
struct Placed {
  KeyFrameId id;
  Se3 T_camera_world;
};

// The keyframe and its covisible ones, moved by the match. For a loop, neighbors that share few
// (distant) landmarks are excluded, because they may belong to the old place.
std::vector<Placed> PlaceWindow(const MapSnapshot& map, const LoopMatch& match,
                                const LoopSettings& settings) {
  const KeyFrame& keyframe = *map.Find(match.keyframe);
  const bool loop = keyframe.map == map.MapOf(match.place);
  std::vector<Placed> window{{keyframe.id, match.T_camera_world}};
  for (KeyFrameId id : TiedTo(keyframe, loop ? settings.tied_share : 0)) {
    if (id == match.place) continue;
    const KeyFrame& other = *map.Find(id);
    Se3 T_other_keyframe = other.T_camera_world * keyframe.T_camera_world.Inverse();
    T_other_keyframe.t *= match.growth;
    window.push_back({id, T_other_keyframe * match.T_camera_world});
  }
  std::sort(window.begin(), window.end(),
            [](const Placed& a, const Placed& b) { return a.id < b.id; });
  return window;
}

Sim3 NodeOf(const Se3& T_camera_world, double growth = 1) {
  return {1 / growth, T_camera_world.R, T_camera_world.t / growth};
}

class EssentialGraph {
 public:
  EssentialGraph(const MapSnapshot& map, const LoopCorrection& loop,
                 const std::vector<Placed>& window, const Camera& camera,
                 const LoopSettings& settings)
      : map_(map), settings_(settings), depth_(std::max(loop.match.depth, 0.0)) {
    graph_.with_scale = camera.StereoBaseline() <= 0;
    const MapId within = map.Find(loop.match.keyframe)->map;
    for (KeyFrameId id : map.KeyFramesOf(within)) {
      const KeyFrame& keyframe = *map.Find(id);
      node_[id] = static_cast<int>(ids_.size());
      ids_.push_back(id);
      before_.push_back(NodeOf(keyframe.T_camera_world));
      graph_.fixed.push_back(!keyframe.parent.valid());  // defines the world frame
    }
    graph_.T_camera_world = before_;
    for (const Placed& placed : window) {
      graph_.T_camera_world[node_[placed.id]] = NodeOf(placed.T_camera_world, loop.match.growth);
      in_window_.Enter(placed.id);
    }
    for (KeyFrameId id : ids_) TieAsBefore(*map.Find(id));
    for (const Placed& placed : window) TieToThePlace(placed.id, loop.fused);
    TieByLoop(loop.match.keyframe, loop.match.place);
  }

  std::vector<KeyFrameCorrection> Optimise() {
    PoseGraphSettings settings = settings_.graph;
    if (settings.length_scale == 0) settings.length_scale = depth_;
    OptimizePoseGraph(graph_, settings);
    std::vector<KeyFrameCorrection> corrections;
    for (size_t i = 0; i < ids_.size(); ++i) {
      const Sim3& T = graph_.T_camera_world[i];
      corrections.push_back({ids_[i], {T.R, T.t / T.s}, 1 / T.s});
    }
    return corrections;
  }

 private:
  void Tie(KeyFrameId a, KeyFrameId b, const std::vector<Sim3>& poses) {
    const int *i = node_.Find(a), *j = node_.Find(b);
    if (!i || !j || i == j) return;
    graph_.edges.push_back({*i, *j, poses[*i] * poses[*j].Inverse(), 1.0});
  }

  // Edges with relative poses before the correction. Each pair once, added by the younger keyframe.
  void TieAsBefore(const KeyFrame& keyframe) {
    if (keyframe.parent.valid()) Tie(keyframe.id, keyframe.parent, before_);
    for (KeyFrameId other : keyframe.loops) {
      if (other < keyframe.id && other != keyframe.parent) Tie(keyframe.id, other, before_);
    }
    for (const Neighbour& n : keyframe.covisible) {
      if (n.shared < settings_.graph_shared) break;
      const bool tied = n.id == keyframe.parent ||
                        std::binary_search(keyframe.loops.begin(), keyframe.loops.end(), n.id);
      if (n.id < keyframe.id && !tied) Tie(keyframe.id, n.id, before_);
    }
  }

  // Edges to the keyframes that observe the landmarks found in it, with relative poses after the
  // match.
  void TieToThePlace(KeyFrameId id, const std::vector<FusedSighting>& fused) {
    IdMap<KeyFrameId, int> votes;
    for (const FusedSighting& s : fused) {
      if (s.keyframe != id) continue;
      for (const Observation& o : map_.Find(s.landmark)->observations) ++votes[o.keyframe];
    }
    std::vector<KeyFrameId> tied;
    for (const auto& [other, count] : votes.entries()) {
      if (count >= kMinVotes && !in_window_.Contains(other)) tied.push_back(other);
    }
    std::sort(tied.begin(), tied.end());
    for (KeyFrameId other : tied) Tie(id, other, graph_.T_camera_world);
  }

  void TieByLoop(KeyFrameId keyframe, KeyFrameId place) {
    Tie(keyframe, place, graph_.T_camera_world);
  }

  const MapSnapshot& map_;
  const LoopSettings& settings_;
  // Median depth, the graph's length scale: there, rotation and translation errors have equal
  // weight.
  double depth_;
  IdMap<KeyFrameId, int> node_;  // of this map
  std::vector<KeyFrameId> ids_;
  std::vector<Sim3> before_;
  IdSet<KeyFrameId> in_window_;
  PoseGraph graph_;
};

}  // namespace

LoopCorrection CorrectLoop(const MapSnapshot& map, const LoopMatch& match, const Camera& camera,
                           const LoopSettings& settings) {
  LoopCorrection loop;
  loop.match = match;
  const KeyFrame &keyframe = *map.Find(match.keyframe), &place = *map.Find(match.place);
  const std::vector<Placed> window = PlaceWindow(map, match, settings);
  const std::vector<LandmarkId> around = LandmarksAround(map, place);
  const LandmarkSearch search{settings.search_radius / 2, settings.max_distance, {}};
  for (const Placed& placed : window) {
    loop.window.push_back(placed.id);
    const std::vector<FusedSighting> found =
        FindLandmarks(map, around, *map.Find(placed.id), placed.T_camera_world, camera, search);
    loop.fused.insert(loop.fused.end(), found.begin(), found.end());
  }
  if (keyframe.map == place.map) {
    loop.corrections = EssentialGraph(map, loop, window, camera, settings).Optimise();
    return loop;
  }
  const auto similarity = [](const Se3& T) { return Sim3{1, T.R, T.t}; };
  const Sim3 T_place_here = similarity(match.T_camera_world.Inverse()) *
                            Sim3{match.growth, Eigen::Matrix3d::Identity(), {0, 0, 0}} *
                            similarity(keyframe.T_camera_world);
  const bool here_is_older = keyframe.map < place.map;
  loop.older = std::min(keyframe.map, place.map);
  loop.younger = std::max(keyframe.map, place.map);
  loop.T_older_younger = here_is_older ? T_place_here.Inverse() : T_place_here;
  return loop;
}

bool CommitLoop(MapCommit& commit, const LoopCorrection& loop) {
  const KeyFrame* keyframe = commit.Find(loop.match.keyframe);
  const KeyFrame* place = commit.Find(loop.match.place);
  if (!keyframe || !place) return false;
  if (loop.merges()) {
    const KeyFrameId anchor = keyframe->map == loop.older ? keyframe->id : place->id;
    CommitMerge(commit, loop.younger, loop.older, loop.T_older_younger, anchor);
  } else {
    CommitCorrections(commit, loop.corrections);
  }
  for (LandmarkId landmark : CommitFusion(commit, loop.fused)) commit.RefreshLandmark(landmark);
  commit.AddLoop(loop.match.keyframe, loop.match.place);
  for (KeyFrameId id : loop.window) commit.RefreshCovisibility(id);
  return true;
}

}  // namespace alidade
