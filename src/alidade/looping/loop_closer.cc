#include "alidade/looping/loop_closer.h"

#include <algorithm>

#include "alidade/looping/candidates.h"

namespace alidade {

namespace {

// True if two matches give the keyframe about the same pose in one map.
bool AgreeOnPlace(const MapSnapshot& map, const LoopMatch& a, const LoopMatch& b) {
  constexpr double kTurn = 0.35;   // radians
  constexpr double kShift = 0.35;  // relative to the mean distance of the landmarks found
  const Eigen::Vector3d centre = a.T_camera_world.Inverse().t;
  double distance = 0;
  for (const FusedSighting& s : a.found) {
    distance +=
        (map.Find(s.landmark)->p_world - centre).norm() / static_cast<double>(a.found.size());
  }
  return RotationAngle(a.T_camera_world, b.T_camera_world) < kTurn &&
         (centre - b.T_camera_world.Inverse().t).norm() < kShift * distance;
}

}  // namespace

LoopCloser::LoopCloser(MapStore& map, PlaceIndex& places, const Camera& camera,
                       LoopSettings settings)
    : map_(map), places_(places), camera_(camera), settings_(settings) {
  settings_.Check();
  settings_.noise.right_from_sensor = camera.baseline <= 0;
  if (camera.StereoBaseline() > 0) settings_.tied_share = 0;
}

// Within a map, a match is checked against the path since the place. A match in another map is only
// checked against other matches: if several poses are possible (a corridor of equal doors), none is
// returned.
std::optional<LoopMatch> LoopCloser::Recognise(
    const MapSnapshot& map, KeyFrameId id, const std::function<bool(KeyFrameId)>& may_be) const {
  std::optional<LoopMatch> elsewhere;
  bool ambiguous = false;
  for (KeyFrameId place : FindLoopCandidates(map, places_, id, settings_, may_be)) {
    const bool here = map.MapOf(place) == map.MapOf(id);
    if (!here && ambiguous) continue;
    std::optional<LoopMatch> match = VerifyLoop(map, id, place, camera_, settings_, recording_);
    if (!match) continue;
    if (here) return match;
    const bool same_map = elsewhere && map.MapOf(place) == map.MapOf(elsewhere->place);
    ambiguous = same_map && !AgreeOnPlace(map, *match, *elsewhere);
    if (!elsewhere) elsewhere = std::move(match);
  }
  return ambiguous ? std::nullopt : elsewhere;
}

std::optional<LoopMatch> LoopCloser::Add(KeyFrameId id) {
  const MapSnapshot map = map_.Snapshot();
  std::erase_if(entered_, [&](KeyFrameId old) {
    if (map.Find(old)) return false;
    places_.Remove(old);
    return true;
  });
  const KeyFrame* keyframe = map.Find(id);
  if (!keyframe) return {};
  std::optional<LoopMatch> match;
  if (settings_.enabled) match = Recognise(map, id);
  places_.Add(id, keyframe->frame);
  entered_.push_back(id);
  return match;
}

bool LoopCloser::Close(const LoopMatch& match) {
  const MapSnapshot map = map_.Snapshot();
  if (!map.Find(match.keyframe) || !map.Find(match.place)) return false;
  const LoopCorrection correction = CorrectLoop(map, match, camera_, settings_);
  bool done = false;
  map_.CommitAside([&](MapCommit& commit) { done = CommitLoop(commit, correction); });
  if (done) ++(correction.merges() ? merges_ : loops_);
  return done;
}

void LoopCloser::AdjustAll(
    KeyFrameId id, const std::atomic<bool>* stop,
    const std::function<void(const std::function<void()>&)>& while_mapper_rests) {
  const MapSnapshot map = map_.Snapshot();
  const KeyFrame* keyframe = map.Find(id);
  if (!keyframe) return;
  std::vector<KeyFrameId> free, fixed;
  for (KeyFrameId other : map.KeyFramesOf(keyframe->map)) {
    (map.Find(other)->parent.valid() ? free : fixed).push_back(other);
  }
  Adjustment adjusted =
      AdjustKeyFrames(map, free, fixed, camera_, {settings_.noise, settings_.bundle}, stop);
  adjusted.outliers.clear();  // left to the mapper
  while_mapper_rests([&] {
    map_.CommitAside([&](MapCommit& commit) {
      // Another loop was closed meanwhile.
      if (commit.state().corrections != map.corrections()) return;
      CommitAdjustment(commit, map, adjusted);
      commit.CountCorrection();
    });
  });
}

}  // namespace alidade
