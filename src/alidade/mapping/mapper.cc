#include "alidade/mapping/mapper.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "alidade/base/log.h"
#include "alidade/base/log_odds.h"
#include "alidade/base/median.h"
#include "alidade/map/view.h"
#include "alidade/mapping/free_space.h"
#include "alidade/mapping/fuse.h"
#include "alidade/mapping/limit.h"
#include "alidade/mapping/local_window.h"
#include "alidade/mapping/triangulate.h"
#include "alidade/mapping/turn.h"

namespace alidade {
namespace {

// Seconds after which something that appeared in free space counts as standing there.
constexpr double kSettled = 3;
// Share of a keyframe's features on what passes from which the user is told.
constexpr double kLargePassing = 0.2;

// Number of keyframes of a map, counting stops at `most`.
size_t CountUpTo(size_t most, const MapSnapshot& map, MapId within) {
  size_t count = 0;
  map.keyframes().ForEachFromLast([&](const KeyFrame& keyframe) {
    count += keyframe.map == within;
    return count < most;
  });
  return count;
}

}  // namespace

Mapper::Mapper(MapStore& map, const Camera& camera, MapperSettings settings)
    : map_(map),
      camera_(camera),
      settings_(settings),
      has_depth_(camera.StereoBaseline() > 0),
      young_static_(settings.young_static) {
  settings_.Check();
  settings_.noise.right_from_sensor = camera.baseline <= 0;
}

KeyFrameId Mapper::Insert(std::shared_ptr<const Frame> frame, const Anchor& anchor,
                          std::span<const LandmarkId> matches) {
  KeyFrameId id;
  std::vector<uint8_t> appeared;
  map_.Commit([&](MapCommit& commit) {
    const Se3 T_camera_world = PoseOf(commit.state(), anchor);
    KeyFrame keyframe;
    keyframe.frame = frame;
    keyframe.T_camera_world = T_camera_world;
    keyframe.parent = anchor.keyframe;
    id = commit.Add(std::move(keyframe));
    for (size_t i = 0; i < matches.size(); ++i) {
      // Its map may have been split since the match.
      const Landmark* landmark = matches[i].valid() ? commit.Find(matches[i]) : nullptr;
      if (landmark && commit.Find(landmark->reference)->map == commit.Find(id)->map)
        commit.AddObservation(matches[i], id, static_cast<int>(i));
    }
    const Se3 T_world_camera = T_camera_world.Inverse();
    appeared = Appeared(commit.state(), id);
    for (size_t i = 0; i < frame->keypoints.size(); ++i) {
      const Keypoint& keypoint = frame->keypoints[i];
      if (!MakesLandmark(keypoint) || (!appeared.empty() && appeared[i])) continue;
      if (commit.Find(id)->landmarks[i].valid()) continue;
      Landmark landmark;
      landmark.static_probability = young_static_;
      landmark.p_world = T_world_camera * camera_.Unproject(keypoint.pixel(), keypoint.depth);
      landmark.reference = landmark.born = id;
      landmark.observations = {{id, static_cast<int>(i)}};
      commit.RefreshLandmark(commit.Add(std::move(landmark)));
    }
    commit.RefreshCovisibility(id);
  });
  TellOfPassing(appeared);
  return id;
}

// HasAppeared(), or empty if that does not matter: there is no depth, or the dynamic filter weighs
// all landmarks from the first frame on.
std::vector<uint8_t> Mapper::Appeared(const MapState& map, KeyFrameId keyframe) const {
  if (!has_depth_ || settings_.young_static < 1) return {};
  return HasAppeared(map, camera_, keyframe, kSettled);
}

void Mapper::TellOfPassing(std::span<const uint8_t> appeared) {
  const auto count = std::count(appeared.begin(), appeared.end(), uint8_t{1});
  const double share = static_cast<double>(count) / static_cast<double>(appeared.size());
  if (passing_told_ || !(share > kLargePassing)) return;
  passing_told_ = true;
  LogWarning("something large moves through the image (" +
             std::to_string(std::lround(100 * share)) +
             " % of the features): it is left out of the map");
}

bool Mapper::MakesLandmark(const Keypoint& keypoint) const {
  return keypoint.has_depth() &&
         DepthErrorShare(keypoint, camera_, settings_.noise) <= settings_.max_depth_error;
}

KeyFrameId Mapper::InsertTwoViews(const TwoViewMap& start) {
  KeyFrameId first, second;
  MapSnapshot map = map_.Commit([&](MapCommit& commit) {
    KeyFrame a, b;
    a.frame = start.a;
    b.frame = start.b;
    b.T_camera_world = start.T_b_a;
    first = commit.Add(std::move(a));
    b.parent = first;
    second = commit.Add(std::move(b));
    for (const auto& point : start.points) {
      Landmark landmark;
      landmark.p_world = point.p_a;
      landmark.static_probability = young_static_;
      landmark.reference = first;
      landmark.born = second;
      landmark.observations = {{first, point.keypoint_a}, {second, point.keypoint_b}};
      commit.RefreshLandmark(commit.Add(std::move(landmark)));
    }
    commit.RefreshCovisibility(second);
  });
  AdjustSettings thorough{settings_.noise, settings_.bundle, settings_.min_noise_ratio};
  thorough.bundle.max_iterations = 20;
  const Adjustment adjusted =
      AdjustKeyFrames(map, {second}, {first}, camera_, thorough, nullptr, second);
  map_.Commit([&](MapCommit& commit) {
    CommitAdjustment(commit, map, adjusted);
    std::vector<double> depths;
    std::vector<LandmarkId> good;
    for (const auto& [id, p_world] : adjusted.points) {
      const Landmark* landmark = commit.Find(id);
      if (!landmark) continue;
      if (landmark->observations.size() < 2) {
        commit.Remove(id);
        continue;
      }
      good.push_back(id);
      depths.push_back(landmark->p_world.z());
    }
    if (depths.empty()) return;
    const double scale = 1 / UpperMedian(depths);
    commit.Edit(second)->T_camera_world.t *= scale;
    for (LandmarkId id : good) {
      commit.Edit(id)->p_world *= scale;
      commit.RefreshLandmark(id);
    }
  });
  return second;
}

void Mapper::Count(std::span<const std::pair<LandmarkId, bool>> sightings) {
  std::lock_guard<std::mutex> lock(tallies_mutex_);
  for (const auto& [id, found] : sightings) {
    SightingTally& tally = tallies_[id];
    ++tally.expected;
    tally.found += found;
  }
}

void Mapper::Restore(const MapSnapshot& map) {
  constexpr float kLeast = 0.02f;
  std::lock_guard<std::mutex> lock(tallies_mutex_);
  for (LandmarkId id : map.Landmarks()) {
    const float p = std::clamp(map.Find(id)->static_probability, kLeast, 1 - kLeast);
    tallies_[id].static_log_odds = LogOddsOf(p);
  }
}

void Mapper::Doubt(std::span<const std::pair<LandmarkId, float>> evidence) {
  // Log-odds; bounds the time to revise a long-held belief to about 1 s.
  constexpr float kBound = 4;
  std::lock_guard<std::mutex> lock(tallies_mutex_);
  for (const auto& [id, log_odds] : evidence) {
    SightingTally& tally = tallies_[id];
    tally.static_log_odds = std::clamp(tally.static_log_odds + log_odds, -kBound, kBound);
    if (!tally.doubted) doubted_.push_back(id);
    tally.doubted = true;
  }
}

// Returns the static probabilities of all landmarks with new evidence, by id.
std::vector<std::pair<LandmarkId, float>> Mapper::TakeBelief() {
  std::lock_guard<std::mutex> lock(tallies_mutex_);
  std::sort(doubted_.begin(), doubted_.end());
  std::vector<std::pair<LandmarkId, float>> belief;
  for (LandmarkId id : doubted_) {
    SightingTally& tally = tallies_[id];
    tally.doubted = false;
    belief.push_back({id, ProbabilityOf(tally.static_log_odds)});
  }
  doubted_.clear();
  return belief;
}

// Removes tallies of deleted landmarks once they are the majority, which keeps the amortized cost
// low.
void Mapper::ForgetTalliesOfTheGone(const MapSnapshot& map) {
  constexpr size_t kSpare = 1024;
  std::lock_guard<std::mutex> lock(tallies_mutex_);
  if (tallies_.size() < 2 * static_cast<size_t>(map.landmark_count()) + kSpare) return;
  // Keep ids newer than `map`, and unread evidence.
  tallies_.EraseIf([&](LandmarkId id, const SightingTally& tally) {
    return !map.Find(id) && id.value < map.next_landmark() && !tally.doubted;
  });
}

MapperReport Mapper::Process(KeyFrameId id, const std::atomic<bool>* stop) {
  MapperReport report;
  MapSnapshot map = map_.Snapshot();
  if (!map.Find(id)) return report;

  ForgetTalliesOfTheGone(map);
  // Landmarks created with the keyframe are on probation too.
  for (LandmarkId landmark : map.Find(id)->landmarks) {
    if (landmark.valid() && map.Find(landmark)->born == id) young_.push_back(landmark);
  }
  std::vector<LandmarkId> still_young;
  std::vector<LandmarkId> weak;
  {
    std::lock_guard<std::mutex> lock(tallies_mutex_);
    weak = FindWeakLandmarks(map, young_, tallies_, id, has_depth_, settings_, still_young);
  }
  young_ = std::move(still_young);
  const std::vector<std::pair<LandmarkId, float>> belief = TakeBelief();
  for (const auto& [landmark, probability] : belief) {
    if (probability < settings_.least_static) weak.push_back(landmark);
  }
  report.landmarks_culled = static_cast<int>(weak.size());
  map = map_.Commit([&](MapCommit& commit) {
    for (const auto& [landmark, probability] : belief) {
      const float entered = probability > settings_.sure_static ? 1 : probability;
      const Landmark* before = commit.Find(landmark);
      if (young_static_ >= 1 || !before || before->static_probability == entered) continue;
      commit.Edit(landmark)->static_probability = entered;
    }
    for (LandmarkId landmark : weak) commit.Remove(landmark);
    const std::vector<LandmarkId> seen = commit.Find(id)->landmarks;
    for (LandmarkId landmark : seen) {
      if (landmark.valid()) commit.RefreshLandmark(landmark);
    }
  });

  std::vector<KeyFrameId> at_known_distance;
  std::vector<LandmarkId> scale_found;
  if (!has_depth_) {
    at_known_distance = AtKnownDistance(map, *map.Find(id), camera_, settings_);
    scale_found = ScaleFoundFrom(map, *map.Find(id), at_known_distance);
  }
  std::vector<NewLandmark> made = TriangulateNew(map, id, at_known_distance, camera_, settings_);
  if (!has_depth_) {
    const std::vector<NewLandmark> turned = MapTurn(map, id, made, camera_, settings_);
    made.insert(made.end(), turned.begin(), turned.end());
  }
  if (!made.empty()) {
    const std::vector<uint8_t> appeared = Appeared(map.state(), id);
    if (!appeared.empty())
      std::erase_if(made,
                    [&](const NewLandmark& entry) { return appeared[entry.second.keypoint]; });
  }
  report.triangulated = static_cast<int>(made.size());
  map = map_.Commit([&](MapCommit& commit) {
    for (LandmarkId found : scale_found) commit.Edit(found)->scale_known = true;
    for (const NewLandmark& entry : made) {
      Landmark landmark;
      landmark.p_world = entry.p_world;
      landmark.static_probability = young_static_;
      landmark.reference = landmark.born = id;
      landmark.observations = {entry.first, entry.second};
      landmark.scale_known = entry.scale_known;
      landmark.depth_assumed = entry.depth_assumed;
      const LandmarkId added = commit.Add(std::move(landmark));
      if (commit.Find(added)->observations.size() < 2) {
        commit.Remove(added);
        continue;
      }
      commit.RefreshLandmark(added);
      young_.push_back(added);
    }
  });

  const std::vector<FusedSighting> duplicates = FindDuplicates(map, id, camera_, settings_);
  report.fused = static_cast<int>(duplicates.size());
  map = map_.Commit([&](MapCommit& commit) {
    for (LandmarkId landmark : CommitFusion(commit, duplicates)) commit.RefreshLandmark(landmark);
    commit.RefreshCovisibility(id);
  });

  const size_t keyframes = CountUpTo(3, map, map.Find(id)->map);
  if (keyframes < 2) return report;
  if (keyframes > 2 || has_depth_) {
    const Adjustment adjusted = AdjustWindow(map, id, camera_, settings_, stop);
    report.bundle = adjusted.report;
    map = map_.Commit([&](MapCommit& commit) {
      CommitAdjustment(commit, map, adjusted);
      for (const auto& [landmark, keyframe] : adjusted.outliers) {
        const Landmark* l = commit.Find(landmark);
        if (l && l->observations.size() < (has_depth_ ? 1 : 2)) commit.Remove(landmark);
      }
      for (const auto& [landmark, p_world] : adjusted.points) commit.RefreshLandmark(landmark);
    });
  }

  const std::vector<KeyFrameId> redundant = FindRedundantKeyFrames(map, id, has_depth_, settings_);
  report.keyframes_culled = static_cast<int>(redundant.size());
  Remove(redundant);
  report.split = SplitWhereScaleIsUnknown(id);
  return report;
}

MapId Mapper::SplitWhereScaleIsUnknown(KeyFrameId id) {
  const MapSnapshot map = map_.Snapshot();
  const KeyFrame* newest = map.Find(id);
  if (has_depth_ || !newest) return {};
  const auto knows = [&](const KeyFrame& keyframe) {
    return HasMeasuredMotion(map, keyframe) ||
           CountOfKnownScale(map, keyframe) >= settings_.min_known_scale;
  };
  // Consecutive keyframes without known scale, newest first, because a split moves all keyframes
  // from one on. The interval restarts when its oldest keyframe is culled, which happens while the
  // camera stays in place.
  std::vector<const KeyFrame*> unknown;
  for (uint32_t i = id.value + 1; i-- > 0;) {
    const KeyFrame* keyframe = map.Find(KeyFrameId{i});
    if (!keyframe || keyframe->map != newest->map) continue;
    if (knows(*keyframe)) break;
    unknown.push_back(keyframe);
  }
  if (unknown.empty() ||
      newest->frame->time - unknown.back()->frame->time < settings_.max_unknown_scale_seconds)
    return {};
  // Keyframe of known scale where this stretch began. Found via the spanning tree, because the
  // camera may have been relocalized in an earlier part without scale.
  const KeyFrame* known = newest;
  while (known && !knows(*known)) known = map.Find(known->parent);
  if (!known) return {};
  const auto elsewhere = std::find_if(unknown.rbegin(), unknown.rend(), [&](const KeyFrame* at) {
    const double moved = (at->Centre() - known->Centre()).norm();
    return moved > settings_.max_unknown_scale_motion * MedianDepth(map, *at).value_or(1);
  });
  if (elsewhere == unknown.rend()) return {};
  MapId split;
  map_.Commit([&](MapCommit& commit) { split = commit.Split((*elsewhere)->id); });
  return split == newest->map ? MapId{} : split;
}

void Mapper::Remove(std::span<const KeyFrameId> keyframes) {
  if (keyframes.empty()) return;
  map_.Commit([&](MapCommit& commit) {
    for (KeyFrameId gone : keyframes) {
      const KeyFrame* keyframe = commit.Find(gone);
      if (!keyframe) continue;
      const std::vector<LandmarkId> seen = keyframe->landmarks;
      commit.Remove(gone);
      for (LandmarkId landmark : seen) {
        if (landmark.valid()) commit.RefreshLandmark(landmark);
      }
    }
  });
}

int Mapper::KeepWithinLimit(KeyFrameId newest) {
  constexpr int kBatches = 20;  // of the limit
  const MapSnapshot map = map_.Snapshot();
  const int limit = settings_.max_keyframes;
  if (limit == 0 || map.keyframe_count() <= limit) return 0;
  const std::vector<KeyFrameId> gone =
      FindLeastUseful(map, newest, map.keyframe_count() - limit + limit / kBatches);
  Remove(gone);
  return static_cast<int>(gone.size());
}

}  // namespace alidade
