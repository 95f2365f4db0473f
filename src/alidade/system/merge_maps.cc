#include "alidade/system/merge_maps.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/looping/loop_closer.h"
#include "alidade/mapping/fuse.h"
#include "alidade/system/camera/change_camera.h"
#include "alidade/system/saved_settings.h"
#include "alidade/system/settings.h"

namespace alidade {
namespace {

constexpr int kTyingRounds = 3;  // the second finds a few more places, the third hardly any

// The settings that the map was made with, for merging.
SlamSettings MergeSettings(const SavedMap& saved) {
  SlamSettings settings = SettingsOf(saved);
  settings.loop.enabled = true;
  // Keyframes that share any landmark are no candidates for each other: Tie() matches the others.
  settings.loop.tied_share = 0;
  return settings;
}

// Indices of the maps, the largest first. Throws Error (input) if two maps are equal.
std::vector<size_t> BySize(const std::vector<MapToMerge>& maps) {
  const auto size = [](const MapToMerge& map) {
    return std::pair(map.saved.map.keyframe_count(), map.saved.map.landmark_count());
  };
  std::vector<size_t> order(maps.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<std::string> bytes(maps.size());  // only of maps of equal size
  const auto bytes_of = [&](size_t i) -> const std::string& {
    if (bytes[i].empty()) bytes[i] = EncodeMap(maps[i].saved);
    return bytes[i];
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    if (a == b) return false;
    if (size(maps[a]) != size(maps[b])) return size(maps[a]) > size(maps[b]);
    if (bytes_of(a) == bytes_of(b))
      ThrowInput(maps[a].name + " and " + maps[b].name + " are the same map");
    return bytes_of(a) < bytes_of(b);
  });
  return order;
}

// Throws Error (input) if the maps cannot be merged.
void CheckTogether(const MapToMerge& first, const MapToMerge& other) {
  const std::string why = WhyNotTogether(first.saved, other.saved);
  if (!why.empty()) ThrowInput(other.name + " cannot be merged with " + first.name + ": " + why);
}

class Merger {
 public:
  Merger(const SavedMap& like, MapUnion all, const MergeProgress& progress)
      : settings_(MergeSettings(like)),
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

  // Matches every keyframe with places of other maps and joins the maps. True if any were joined:
  // then more landmarks surround the places, and keyframes without a match are worth another try.
  bool JoinOnce() {
    bool any = false;
    ForEachKeyFrame("searching for common places", [&](KeyFrameId id) {
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

  // Matches the keyframes of joined maps with places that come from another input map and share no
  // landmarks with them yet. Returns the number of matches.
  int Tie() {
    int found = 0;
    ForEachKeyFrame("connecting the maps", [&](KeyFrameId id) {
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

  // Fuses duplicate landmarks around each keyframe, as the mapper does around a new one.
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

  void Adjust(MapId id) {
    AdjustWholeMap(map_, id, camera_, settings_, [&](const char* round, int keyframes) {
      if (progress_) progress_(round, 0, keyframes);
    });
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
  std::set<MapId> joined_;  // maps that others were merged into
  int ties_ = 0;
};

}  // namespace

std::string WhyNotTogether(const SavedMap& first, const SavedMap& other) {
  if (first.sensor != other.sensor) {
    return "it was made with a " + other.sensor + " camera, the other with a " + first.sensor +
           " camera; run both with the same --sensor";
  }
  if (first.sensor == NameOf(Sensor::kMono) && MayBeOneCamera(first.camera, other.camera))
    return {};
  try {
    CheckSameCamera(first.camera, other.camera);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

MergedMaps MergeMaps(const std::vector<MapToMerge>& maps, const MergeProgress& progress) {
  if (maps.size() < 2) ThrowUsage("nothing to merge: give at least two maps");
  const std::vector<size_t> order = BySize(maps);
  const MapToMerge& first = maps[order.front()];
  for (size_t i : order) {
    if (i != order.front()) CheckTogether(first, maps[i]);
  }
  std::vector<double> shifts(maps.size(), 0);
  std::vector<MapSnapshot> sorted;
  for (size_t i : order) {
    const SavedMap& saved = maps[i].saved;
    const double shift = CameraShift(first.saved.camera, saved.camera);
    if (shift < kSameCamera) {
      sorted.push_back(saved.map);
      continue;
    }
    if (progress) progress("changing the camera", 0, saved.map.keyframe_count());
    shifts[i] = shift;
    sorted.push_back(WithCamera(saved, first.saved.camera, SettingsOf(first.saved)).map);
  }
  const MapUnion all = Unite(sorted);
  Merger merger(first.saved, all, progress);
  merger.Run();

  MergedMaps merged;
  merged.saved = first.saved;
  merged.saved.map = merger.map();
  merged.saved.places = merger.places();
  merged.joins = merger.joins();
  merged.ties = merger.ties();
  merged.camera_shifts = std::move(shifts);
  merged.parts.resize(maps.size());
  for (size_t i = 0; i < order.size(); ++i) merged.parts[order[i]] = all.parts[i];
  return merged;
}

}  // namespace alidade
