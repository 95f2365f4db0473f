#include "alidade/system/workers.h"

#include "alidade/system/prepare.h"

namespace alidade {
namespace {

Schedule Behind(const SlamSettings& settings) {
  return settings.threaded ? Schedule::kBackground : Schedule::kInline;
}

}  // namespace

Workers::Workers(const Camera& camera, const SlamSettings& settings)
    : places_(settings.places, settings.seed),
      mapper_(map_, camera, settings.mapper),
      loop_closer_(map_, places_, camera, settings.loop),
      semidense_mapper_(map_, camera, settings.semidense),
      dense_(settings.semidense.enabled && !settings.localise),
      adjusting_([this](KeyFrameId id, const std::atomic<bool>* stop) { AdjustAll(id, stop); },
                 Behind(settings)),
      looping_([this](KeyFrameId id, const std::atomic<bool>*) { Loop(id); }, Behind(settings)),
      semidense_([this](KeyFrameId, const std::atomic<bool>*) { semidense_mapper_.Process(); },
                 Behind(settings)),
      mapping_([this](KeyFrameId id, const std::atomic<bool>* stop) { Map(id, stop); },
               settings.threaded ? Schedule::kThread : Schedule::kInline) {}

Workers::~Workers() {  // who hands on stops before who is handed to
  mapping_.Stop();
  semidense_.Stop();
  looping_.Stop();
  adjusting_.Stop();
}

void Workers::Map(KeyFrameId id, const std::atomic<bool>* stop) {
  mapper_.Process(id, stop);
  AddMapped(id);
}

void Workers::AddMapped(KeyFrameId id) {
  looping_.Add(id);
  if (dense_) semidense_.Add(id);
}

void Workers::Keep(KeyFrameId id, const Picture* picture) {
  if (picture) semidense_mapper_.Keep(id, Copied(*picture));
}

void Workers::Loop(KeyFrameId id) {
  const std::optional<LoopMatch> match = loop_closer_.Add(id);
  if (!match) return;
  bool closed = false;
  mapping_.WhileResting([&] { closed = loop_closer_.Close(*match); });
  if (!closed) return;
  adjusting_.Add(id);
}

void Workers::AdjustAll(KeyFrameId id, const std::atomic<bool>* stop) {
  loop_closer_.AdjustAll(
      id, stop, [this](const std::function<void()>& commit) { mapping_.WhileResting(commit); });
}

SemiDenseReport Workers::SemiDense() {
  SemiDenseReport report;
  semidense_.WhileResting([&] { report = semidense_mapper_.report(); });
  return report;
}

void Workers::Drain() {
  mapping_.Drain();
  looping_.Drain();
  adjusting_.Drain();
  // Local windows leave a slow drift of scale and shape that all observations together do not.
  const MapSnapshot map = map_.Snapshot();
  if (map.next_keyframe() != adjusted_up_to_) {
    adjusted_up_to_ = map.next_keyframe();
    for (MapId id : map.Maps()) {
      const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(id);
      if (keyframes.size() <= 2) continue;
      adjusting_.Add(keyframes.back());
      adjusting_.Drain();  // one by one: what waits would hurry the one before
    }
  }
  semidense_.Drain();
  if (dense_) semidense_mapper_.Finish();
}

void Workers::WhileResting(const std::function<void()>& change) {
  // The loop closer waits for the mapper, and so must come to rest first.
  looping_.WhileResting([&] { mapping_.WhileResting(change); });
}

void Workers::Restore(const SavedMap& saved) {
  map_.Restore(saved.map);
  mapper_.Restore(saved.map);
  const std::vector<KeyFrameId> ids = saved.map.KeyFrames();
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Frame>>> keyframes;
  for (KeyFrameId id : ids) keyframes.push_back({id, saved.map.Find(id)->frame});
  places_.Restore(saved.places, keyframes);
  loop_closer_.SetEntered(ids);
  adjusted_up_to_ = saved.map.next_keyframe();
}

void Workers::Drop(MapId id) {
  WhileResting([&] {
    for (KeyFrameId keyframe : map_.Snapshot().KeyFramesOf(id)) places_.Remove(keyframe);
    map_.Commit([&](MapCommit& commit) { commit.Remove(id); });
  });
}

}  // namespace alidade
