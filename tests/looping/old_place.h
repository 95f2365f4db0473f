// A camera that moves around a ring and returns to its start with accumulated drift.
#pragma once

#include "alidade/looping/close.h"
#include "alidade/looping/verify.h"
#include "problems/drifted_map.h"

namespace alidade {

inline constexpr int kLap = 30;    // views per lap
inline constexpr int kViews = 36;  // the last six views repeat the first six

struct OldPlaceSettings {
  bool depth = false;
  DriftedMapSettings drifted = {};
  int points = 2000;
  int changed = 0;     // percentage of points with another descriptor in the second lap
  bool moved = false;  // the remaining descriptors are permuted
};

struct OldPlace {
  SyntheticWorld world;
  MapStore store;
  DriftedMap made;
  LoopSettings settings;

  KeyFrameId KeyFrameOf(int view) const { return made.keyframes[view]; }
  MapSnapshot map() const { return store.Snapshot(); }
  std::optional<LoopMatch> Verify(int view, int place) const {
    return VerifyLoop(map(), KeyFrameOf(view), KeyFrameOf(place), world.camera, settings);
  }
};

inline SyntheticWorld MakeRing(const OldPlaceSettings& settings) {
  const SyntheticWorldSettings ring{.points = settings.points,
                                    .cameras = kViews,
                                    .noise_px = 0.5,
                                    .flipped_bits = 12,
                                    .clutter = 60,
                                    .depth = settings.depth,
                                    .ring = 3,
                                    .lap = kLap};
  SyntheticWorld world = MakeSyntheticWorld(ring);
  if (settings.changed == 0 && !settings.moved) return world;
  // In the second half, change or permute the descriptors of points.
  Random random(5);
  std::vector<Descriptor> looks = world.descriptors;
  for (Descriptor& descriptor : looks) {
    if (static_cast<int>(random.Below(100)) < settings.changed)
      descriptor = RandomDescriptor(random);
  }
  if (settings.moved) {
    for (size_t i = looks.size() - 1; i > 0; --i)
      std::swap(looks[i], looks[random.Below(static_cast<uint32_t>(i + 1))]);
  }
  for (int v = kLap / 2; v < kViews; ++v) {
    auto frame = std::make_shared<Frame>(*world.views[v].frame);
    for (size_t k = 0; k < frame->descriptors.size(); ++k) {
      const int point = world.views[v].points[k];
      if (point >= 0) frame->descriptors[k] = WithFlippedBits(looks[point], 12, random);
    }
    world.views[v].frame = std::move(frame);
  }
  return world;
}

inline std::unique_ptr<OldPlace> ComeBack(const OldPlaceSettings& settings) {
  auto place = std::make_unique<OldPlace>();
  place->world = MakeRing(settings);
  place->made = FillDriftedMap(place->world, settings.drifted, place->store);
  return place;
}

// Constant drift per step in translation, rotation and scale between views 8 and 22; none before
// and after.
inline DriftedMapSettings DriftInTheMiddle(double metres, double radians, double growth = 1) {
  DriftedMapSettings settings;
  settings.drift_first = 9;
  settings.drift_last = 22;
  const double steps = settings.drift_last - settings.drift_first + 1;
  settings.drift << metres * 0.8, metres * 0.1, -metres * 0.59, radians * 0.3, radians * 0.9,
      radians * 0.3;
  settings.drift /= steps;
  settings.growth = std::pow(growth, 1 / steps);
  return settings;
}

// Lets the keyframe of `view` observe a tenth of its landmarks as those of the old place's
// keyframe.
inline void ShareATenth(OldPlace& place, int view, int old_view) {
  place.store.Commit([&](MapCommit& commit) {
    const KeyFrameId id = place.KeyFrameOf(view), old = place.KeyFrameOf(old_view);
    const std::vector<int>&now = place.world.views[view].points,
          &then = place.world.views[old_view].points;
    const std::vector<LandmarkId> landmarks = commit.Find(id)->landmarks;
    auto tenth = std::count_if(landmarks.begin(), landmarks.end(),
                               [](LandmarkId landmark) { return landmark.valid(); }) /
                 10;
    for (size_t k = 0; k < now.size() && tenth > 0; ++k) {
      const auto at = std::find(then.begin(), then.end(), now[k]);
      if (now[k] < 0 || at == then.end()) continue;
      const LandmarkId known = commit.Find(old)->landmarks[at - then.begin()];
      if (!landmarks[k].valid() || !known.valid()) continue;
      commit.RemoveObservation(landmarks[k], id);
      commit.AddObservation(known, id, static_cast<int>(k));
      --tenth;
    }
    ASSERT_EQ(tenth, 0);
    commit.RefreshCovisibility(id);
  });
}

inline double Apart(const Se3& a, const Se3& b) { return (a.Inverse().t - b.Inverse().t).norm(); }

}  // namespace alidade
