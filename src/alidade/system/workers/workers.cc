#include "alidade/system/workers/workers.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "alidade/base/log.h"
#include "alidade/calibration/camera_correction.h"
#include "alidade/map/correction.h"
#include "alidade/system/prepare.h"

namespace alidade {
namespace {

// Schedule of the stages behind the mapper.
Schedule Behind(const SlamSettings& settings) {
  return settings.threaded ? Schedule::kBackground : Schedule::kInline;
}

// Runs an action after some seconds on its own thread, unless it is destroyed earlier.
class Alarm {
 public:
  Alarm(double seconds, std::function<void()> action)
      : thread_([this, seconds, action = std::move(action)] {
          std::unique_lock<std::mutex> lock(mutex_);
          const auto time = std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e8));
          if (!changed_.wait_for(lock, time, [this] { return cancelled_; })) action();
        }) {}
  ~Alarm() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      cancelled_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool cancelled_ = false;
  std::thread thread_;  // last, since it uses the other members
};

}  // namespace

Workers::Workers(const Camera& camera, const SlamSettings& settings)
    : places_(settings.places, settings.seed),
      mapper_(map_, camera, settings.mapper),
      readout_watch_(camera, settings.mapper.noise, settings.readout),
      lens_watch_(camera, settings.mapper.noise, settings.refine),
      loop_closer_(map_, places_, camera, settings.loop),
      semidense_mapper_(map_, camera, settings.semidense),
      dense_(settings.semidense.enabled && !settings.localize),
      waits_(settings.wait_for_mapping),
      mapping_on_(!settings.localize),
      adjusting_([this](KeyFrameId id, const std::atomic<bool>* stop) { AdjustAll(id, stop); },
                 Behind(settings)),
      looping_([this](KeyFrameId id, const std::atomic<bool>*) { Loop(id); }, Behind(settings)),
      semidense_([this](KeyFrameId, const std::atomic<bool>*) { semidense_mapper_.Process(); },
                 Behind(settings)),
      mapping_([this](KeyFrameId id, const std::atomic<bool>* stop) { Map(id, stop); },
               settings.threaded ? Schedule::kThread : Schedule::kInline) {
  BeginRecording();
}

Workers::~Workers() {  // a stage stops before those that it adds to
  mapping_.Stop();
  semidense_.Stop();
  looping_.Stop();
  adjusting_.Stop();
}

void Workers::MapKeyFrame(KeyFrameId id, const std::atomic<bool>* stop) {
  const MapperReport report = mapper_.Process(id, stop);
  if (!report.split.valid()) return;
  const std::lock_guard<std::mutex> lock(news_mutex_);
  unknown_scale_.push_back(report.split);
}

WorkerNews Workers::TakeNews() {
  WorkerNews news;
  news.camera = lens_watch_.Take();
  const std::lock_guard<std::mutex> lock(news_mutex_);
  news.unknown_scale.swap(unknown_scale_);
  return news;
}

void Workers::Map(KeyFrameId id, const std::atomic<bool>* stop) {
  MapKeyFrame(id, stop);
  if (readout_watch_.Mapped(id, map_.Snapshot())) {
    map_.Commit([&](MapCommit& commit) { CommitShutter(commit, readout_watch_.camera()); });
    adjusting_.Add(id);
  }
  lens_watch_.Mapped(map_.Snapshot());
  if (mapper_.KeepWithinLimit(id) > 0 && !std::exchange(limit_told_, true))
    LogWarning(
        "the map has reached its limit of keyframes (mapper.max_keyframes): the least useful ones "
        "are removed");
  AddMapped(id);
}

void Workers::AddMapped(KeyFrameId id) {
  looping_.Add(id);
  if (dense_) semidense_.Add(id);
}

void Workers::Keep(KeyFrameId id, const Picture* picture) {
  if (!picture) return;
  semidense_.Guard([&] { semidense_mapper_.Keep(id, Copied(*picture)); });
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
  if (cut_short_) return;
  loop_closer_.AdjustAll(
      id, stop ? stop : &cut_short_,
      [this](const std::function<void()>& commit) { mapping_.WhileResting(commit); });
}

// The mapper rests last: work in progress in the other stages may itself need it to rest.
void Workers::WhileAllRest(const std::function<void()>& action) {
  adjusting_.WhileResting([&] {
    looping_.WhileResting(
        [&] { semidense_.WhileResting([&] { mapping_.WhileResting([&] { action(); }); }); });
  });
}

void Workers::AskForCamera() {
  mapping_.WhileResting([&] { lens_watch_.Ask(map_.Snapshot(), true); });
}

void Workers::AskAnew() {
  mapping_.WhileResting([&] { lens_watch_.BeginAnew(); });
}

void Workers::ChangeCamera(const Camera& from, const Camera& to) {
  const auto steps = static_cast<int>(std::ceil(Apart(from, to) / lens_watch_.settings().step));
  const auto at_once = [](const std::function<void()>& commit) { commit(); };
  WhileAllRest([&] {
    for (int i = 1; i <= steps; ++i) {
      const Camera camera = Between(from, to, static_cast<double>(i) / steps);
      map_.Commit([&](MapCommit& commit) { CommitCamera(commit, camera); });
      loop_closer_.SetCamera(camera);
      const MapSnapshot map = map_.Snapshot();
      for (MapId id : map.Maps()) {
        const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(id);
        if (keyframes.size() > 2) loop_closer_.AdjustAll(keyframes.back(), nullptr, at_once);
      }
    }
    mapper_.SetCamera(to);
    map_.Commit([&](MapCommit& commit) {
      for (LandmarkId id : map_.Snapshot().Landmarks()) commit.RefreshLandmark(id);
    });
    if (Apart(from, to) > lens_watch_.settings().rework) {
      for (KeyFrameId id : map_.Snapshot().KeyFrames()) MapKeyFrame(id, nullptr);
    }
    semidense_mapper_.SetCamera(to);
    readout_watch_.SetCamera(to);
    lens_watch_.SetCamera(to);
  });
}

void Workers::Scale(MapId id, double factor) {
  WhileAllRest([&] {
    map_.Commit([&](MapCommit& commit) {
      std::vector<KeyFrameCorrection> corrections;
      commit.state().keyframes.ForEach([&](const KeyFrame& keyframe) {
        if (keyframe.map != id) return;
        Se3 T = keyframe.T_camera_world;
        T.t *= factor;
        corrections.push_back({keyframe.id, T, factor});
      });
      CommitCorrections(commit, corrections);
    });
  });
}

void Workers::Join(MapId younger, MapId older, const Sim3& T_older_younger, KeyFrameId anchor) {
  WhileAllRest([&] {
    const MapSnapshot map = map_.Snapshot();
    map_.Commit([&](MapCommit& commit) {
      CommitMerge(commit, younger, older, T_older_younger, anchor);
      for (LandmarkId id : map.Landmarks()) {
        const Landmark* landmark = map.Find(id);
        if (!landmark->scale_known && !landmark->depth_assumed &&
            map.MapOf(landmark->reference) == younger)
          commit.Edit(id)->scale_known = true;  // by what T_older_younger is from
      }
    });
  });
}

void Workers::CutNow() {
  cut_short_ = true;
  for (Stage* stage : {&mapping_, &looping_, &adjusting_, &semidense_}) stage->GiveUp();
}

void Workers::CutShort() {
  const std::lock_guard<std::mutex> lock(cut_mutex_);
  cut_next_ = !finishing_;
  if (finishing_) CutNow();
}

void Workers::FinishWithin(double limit, const std::function<void()>& finish) {
  struct Ending {
    Workers& workers;
    ~Ending() {
      const std::lock_guard<std::mutex> lock(workers.cut_mutex_);
      workers.finishing_ = workers.cut_short_ = false;
    }
  };
  {
    const std::lock_guard<std::mutex> lock(cut_mutex_);
    finishing_ = true;
    if (std::exchange(cut_next_, false)) CutNow();
  }
  const Ending ending{*this};
  // Without a limit there is no timer: the result does not depend on the clock.
  std::optional<Alarm> alarm;
  if (std::isfinite(limit)) alarm.emplace(limit, [this] { CutShort(); });
  finish();
}

void Workers::Drain() {
  if (cut_short_) CutNow();  // work added since
  mapping_.Drain();
  looping_.Drain();
  adjusting_.Drain();
  adjusting_.Guard([&] {
    // Local adjustments leave a slow drift of scale and shape, which an adjustment of the whole map
    // removes.
    const MapSnapshot map = map_.Snapshot();
    if (map.next_keyframe() == adjusted_up_to_) return;
    for (MapId id : map.Maps()) {
      if (cut_short_) break;
      const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(id);
      if (keyframes.size() <= 2) continue;
      adjusting_.Add(keyframes.back());
      adjusting_.Drain();  // one at a time: a queued map would end the one before early
    }
    if (!cut_short_) adjusted_up_to_ = map.next_keyframe();
  });
  semidense_.Drain();
  if (dense_) semidense_.Guard([&] { semidense_mapper_.Finish(&cut_short_); });
}

void Workers::Restore(const SavedMap& saved) {
  const std::vector<KeyFrameId> ids = saved.map.KeyFrames();
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Frame>>> keyframes;
  for (KeyFrameId id : ids) keyframes.push_back({id, saved.map.Find(id)->frame});
  places_.Restore(saved.places, keyframes);
  loop_closer_.SetEntered(ids);
  mapper_.Restore(saved.map);
  map_.Restore(saved.map);  // last: if a step before it throws, no part of the map is visible
  adjusted_up_to_ = saved.map.next_keyframe();
  BeginRecording();
}

void Workers::BeginRecording() {
  loop_closer_.BeginRecording(KeyFrameId{map_.Snapshot().next_keyframe()});
}

// Runs on the loop closer's thread while the mapper rests: work in progress of either may use the
// map, so it must end first.
void Workers::Drop(MapId id) {
  {
    std::lock_guard<std::mutex> lock(dropped_mutex_);
    dropped_.push_back(id);
  }
  const auto take_out = [this, id] {
    mapping_.WhileResting([&] {
      for (KeyFrameId keyframe : map_.Snapshot().KeyFramesOf(id)) places_.Remove(keyframe);
      map_.Commit([&](MapCommit& commit) { commit.Remove(id); });
    });
    std::lock_guard<std::mutex> lock(dropped_mutex_);
    std::erase(dropped_, id);
  };
  if (!looping_.AddErrand(take_out)) take_out();
}

std::vector<MapId> Workers::dropped() const {
  std::lock_guard<std::mutex> lock(dropped_mutex_);
  return dropped_;
}

std::vector<StageHealth> Workers::health() const {
  std::vector<StageHealth> stages;
  const auto add = [&](const char* name, const Stage& stage) {
    stages.push_back(HealthOf(name, stage.failure(), stage.backlog()));
  };
  add("mapping", mapping_);
  add("loop closing", looping_);
  add("full adjustment", adjusting_);
  if (dense_) add("semi-dense mapping", semidense_);
  return stages;
}

bool Workers::any_stopped() const {
  return mapping_.failure() || looping_.failure() || adjusting_.failure() || semidense_.failure();
}

}  // namespace alidade
