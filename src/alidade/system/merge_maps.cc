#include "alidade/system/merge_maps.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/looping/loop_closer.h"
#include "alidade/map/adjust.h"
#include "alidade/mapping/fuse.h"
#include "alidade/system/settings.h"

namespace alidade {
namespace {

constexpr int kTyingRounds = 3;  // the second finds a few places more, a third hardly any

// As the map was made, where this program knows the names.
SlamSettings SettingsOf(const SavedMap& saved) {
  SlamSettings settings;
  for (const auto& [name, value] : saved.settings) {
    try {
      settings.Set(name, value);
    } catch (const Error&) {  // of another version
    }
  }
  settings.loop.enabled = true;
  settings.loop.tied_share = 0;  // what shares any landmark is tied: Tie() looks for the others
  return settings;
}

// Where each stands when they are sorted by size; equal ones are refused.
std::vector<size_t> BySize(const std::vector<MapToMerge>& maps) {
  const auto size = [](const MapToMerge& map) {
    return std::pair(map.saved.map.keyframe_count(), map.saved.map.landmark_count());
  };
  std::vector<size_t> order(maps.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<std::string> bytes(maps.size());  // only of those that are of equal size
  const auto bytes_of = [&](size_t i) -> const std::string& {
    if (bytes[i].empty()) bytes[i] = EncodeMap(maps[i].saved);
    return bytes[i];
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    if (a == b) return false;
    if (size(maps[a]) != size(maps[b])) return size(maps[a]) > size(maps[b]);
    if (bytes_of(a) == bytes_of(b))
      ThrowInput(maps[a].name + " and " + maps[b].name + " are the same map: give it once");
    return bytes_of(a) < bytes_of(b);
  });
  return order;
}

void CheckTogether(const MapToMerge& first, const MapToMerge& other) {
  const std::string both = other.name + " cannot be merged with " + first.name + ": ";
  if (first.saved.sensor != other.saved.sensor) {
    ThrowInput(both + "it was made with a " + other.saved.sensor + " camera, the other with a " +
               first.saved.sensor + " one; run both with the same --sensor");
  }
  try {
    CheckSameCamera(first.saved.camera, other.saved.camera);
  } catch (const Error& error) {
    ThrowInput(both + error.what());
  }
}

class Merger {
 public:
  Merger(const SavedMap& like, MapUnion all, const MergeProgress& progress)
      : settings_(SettingsOf(like)),
        camera_(like.camera),
        all_(std::move(all)),
        progress_(progress),
        places_(settings_.places, settings_.seed),
        closer_(map_, places_, camera_, settings_.loop) {
    settings_.loop.noise.right_from_sensor = camera_.baseline <= 0;
    settings_.mapper.noise.right_from_sensor = camera_.baseline <= 0;
    map_.Restore(all_.map);
  }

  void Run() {
    IndexPlaces();
    while (JoinOnce()) continue;
    if (joined_.empty()) return;
    for (int round = 0; round < kTyingRounds; ++round) {
      Weld();
      const int found = Tie();
      Weld();
      for (MapId id : Joined()) Adjust(id);
      ties_ += found;
      if (found == 0) break;
    }
  }

  MapSnapshot map() const { return map_.Snapshot(); }
  SavedPlaces places() const { return places_.Save(); }
  const std::vector<MapJoin>& joins() const { return joins_; }
  int ties() const { return ties_; }

 private:
  template <typename Do>
  void ForEachKeyFrame(const char* what, const Do& act) {
    const std::vector<KeyFrameId> ids = map().KeyFrames();
    for (size_t i = 0; i < ids.size(); ++i) {
      if (progress_) progress_(what, static_cast<int>(i), static_cast<int>(ids.size()));
      act(ids[i]);
    }
  }

  void IndexPlaces() {
    ForEachKeyFrame("learning places",
                    [&](KeyFrameId id) { places_.Add(id, map().Find(id)->frame); });
  }

  // Asks every keyframe for places of other maps. Whether any two were joined: then there are more
  // landmarks around a place, and those who were refused are asked again.
  bool JoinOnce() {
    bool any = false;
    ForEachKeyFrame("looking for the same place", [&](KeyFrameId id) {
      const MapSnapshot map = map_.Snapshot();
      const MapId here = map.MapOf(id);
      const auto elsewhere = [&](KeyFrameId other) { return map.MapOf(other) != here; };
      const std::optional<LoopMatch> match = closer_.Recognise(map, id, elsewhere);
      if (!match) return;
      const MapId there = map.MapOf(match->place);
      if (!closer_.Close(*match)) return;
      joins_.push_back(
          {match->keyframe, match->place, static_cast<int>(match->found.size()), match->visible});
      joined_.erase(std::max(here, there));
      joined_.insert(std::min(here, there));
      closer_.AdjustAll(id, nullptr, [](const std::function<void()>& commit) { commit(); });
      any = true;
    });
    return any;
  }

  // Places of the joined maps where parts of different origin meet and share no landmarks yet.
  int Tie() {
    int found = 0;
    ForEachKeyFrame("tying the maps together", [&](KeyFrameId id) {
      const MapSnapshot map = map_.Snapshot();
      if (!IsJoined(map, id)) return;
      const auto other_part = [&](KeyFrameId other) {
        return map.MapOf(other) == map.MapOf(id) && all_.PartOf(other) != all_.PartOf(id);
      };
      const std::optional<LoopMatch> match = closer_.Recognise(map, id, other_part);
      if (match && closer_.Close(*match)) ++found;
    });
    return found;
  }

  // What two keyframes both show is one landmark, as the mapper does it for a new keyframe.
  void Weld() {
    ForEachKeyFrame("fusing landmarks", [&](KeyFrameId id) {
      const MapSnapshot map = map_.Snapshot();
      if (!IsJoined(map, id)) return;
      const auto twice = FindDuplicates(map, id, camera_, settings_.mapper);
      if (twice.empty()) return;
      map_.Commit([&](MapCommit& commit) {
        for (LandmarkId landmark : CommitFusion(commit, twice)) commit.RefreshLandmark(landmark);
        commit.RefreshCovisibility(id);
      });
    });
  }

  // The whole map; what does not fit goes, and the rest is adjusted once more.
  void Adjust(MapId id) {
    for (const char* round : {"adjusting all", "adjusting all again"}) {
      const MapSnapshot map = map_.Snapshot();
      const std::vector<KeyFrameId> ids = map.KeyFramesOf(id);
      if (progress_) progress_(round, 0, static_cast<int>(ids.size()));
      std::vector<KeyFrameId> free, fixed;
      for (KeyFrameId keyframe : ids)
        (map.Find(keyframe)->parent.valid() ? free : fixed).push_back(keyframe);
      const AdjustSettings settings{settings_.loop.noise, settings_.loop.bundle};
      const Adjustment adjusted = AdjustKeyFrames(map, free, fixed, camera_, settings, nullptr);
      map_.Commit([&](MapCommit& commit) {
        CommitAdjustment(commit, map, adjusted);
        const size_t needed = camera_.bf() > 0 ? 1 : 2;  // sightings that tell where it is
        for (const auto& [landmark, keyframe] : adjusted.outliers) {
          const Landmark* left = commit.Find(landmark);
          if (left && left->observations.size() < needed) commit.Remove(landmark);
        }
        for (const auto& [landmark, p_world] : adjusted.points) commit.RefreshLandmark(landmark);
        for (KeyFrameId keyframe : ids) commit.RefreshCovisibility(keyframe);
        commit.CountCorrection();
      });
    }
  }

  bool IsJoined(const MapSnapshot& map, KeyFrameId id) const {
    return joined_.count(map.MapOf(id)) > 0;
  }
  std::vector<MapId> Joined() const { return {joined_.begin(), joined_.end()}; }

  SlamSettings settings_;
  Camera camera_;
  MapUnion all_;
  const MergeProgress& progress_;
  MapStore map_;
  PlaceIndex places_;
  LoopCloser closer_;
  std::vector<MapJoin> joins_;
  std::set<MapId> joined_;  // maps that others were laid on
  int ties_ = 0;
};

}  // namespace

MergedMaps MergeMaps(const std::vector<MapToMerge>& maps, const MergeProgress& progress) {
  if (maps.size() < 2) ThrowUsage("there is nothing to merge: give two maps or more");
  const std::vector<size_t> order = BySize(maps);
  const MapToMerge& first = maps[order.front()];
  for (size_t i : order) {
    if (i != order.front()) CheckTogether(first, maps[i]);
  }
  std::vector<MapSnapshot> sorted;
  for (size_t i : order) sorted.push_back(maps[i].saved.map);
  const MapUnion all = Unite(sorted);
  Merger merger(first.saved, all, progress);
  merger.Run();

  MergedMaps merged;
  merged.saved = first.saved;
  merged.saved.map = merger.map();
  merged.saved.places = merger.places();
  merged.joins = merger.joins();
  merged.ties = merger.ties();
  merged.parts.resize(maps.size());
  for (size_t i = 0; i < order.size(); ++i) merged.parts[order[i]] = all.parts[i];
  return merged;
}

}  // namespace alidade
