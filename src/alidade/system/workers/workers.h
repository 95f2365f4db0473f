// The map and the workers behind the tracker: mapper, loop closer, full adjustment and semi-dense
// mapper, each in a Stage. A mapped keyframe goes on to the loop closer and the semi-dense mapper;
// a closed loop starts a full adjustment. Used by the driving thread, except where noted.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "alidade/calibration/lens_watch.h"
#include "alidade/calibration/readout_watch.h"
#include "alidade/looping/loop_closer.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/mapper.h"
#include "alidade/place/place_index.h"
#include "alidade/semidense/semidense_mapper.h"
#include "alidade/system/health.h"
#include "alidade/system/settings.h"
#include "alidade/system/workers/stage.h"

namespace alidade {

// What the workers found since the last call of Workers::TakeNews().
struct WorkerNews {
  std::optional<Camera> camera;      // the map supports this camera rather than the one in use
  std::vector<MapId> unknown_scale;  // maps split off because their scale is unknown
};

class Workers {
 public:
  Workers(const Camera& camera, const SlamSettings& settings);
  ~Workers();

  MapStore& map() { return map_; }
  const MapStore& map() const { return map_; }
  PlaceIndex& places() { return places_; }
  const PlaceIndex& places() const { return places_; }
  Mapper& mapper() { return mapper_; }
  void SetMapping(bool on) { mapping_on_ = on; }  // see Slam::SetMapping()

  // Queues a keyframe for mapping, after which it is passed on as by AddMapped().
  void Add(KeyFrameId id) {
    mapping_.Add(id);
    if (waits_) AwaitPlace();
  }
  void AddMapped(KeyFrameId id);  // queues it for loop closing and semi-dense mapping only
  // Copies the keyframe's images for semi-dense mapping. Call before Add(). Null: there are none.
  void Keep(KeyFrameId id, const Picture* picture);
  // The rolling-shutter readout time estimated so far, seconds; see Camera::readout.
  std::array<double, 2> readout() const { return readout_watch_.readout(); }
  ReadoutWatch& readout_watch() { return readout_watch_; }
  double readout_sigma() const { return readout_watch_.sigma(); }
  void AskForCamera();  // LensWatch::Ask() for the last time; WorkerNews::camera has the result
  void AskAnew();       // LensWatch::BeginAnew()
  void AwaitMapping() { mapping_.Drain(); }  // returns when all keyframes added so far are mapped
  // Returns when all keyframes added so far are mapped and loops with them are closed.
  void AwaitPlace() {
    mapping_.Drain();
    looping_.Drain();
  }
  void AwaitDrop() { looping_.Drain(); }  // returns when the maps to be dropped are removed
  LensWatch& lens_watch() { return lens_watch_; }
  const LensWatch& lens_watch() const { return lens_watch_; }
  // Changes all maps to another camera, in steps with an adjustment after each, while no worker
  // runs. Not while a map is unconfirmed: an adjustment needs three keyframes.
  void ChangeCamera(const Camera& from, const Camera& to);
  // All lengths of a map grow by `factor`. Not while it is unconfirmed.
  void Scale(MapId map, double factor);
  // Moves the map `younger` into `older` (CommitMerge()); they need not show anything in common.
  void Join(MapId younger, MapId older, const Sim3& T_older_younger, KeyFrameId anchor);
  // Runs a function in the background (inline: at once), in which it must not wait. What it throws
  // ends full adjustments.
  void AddErrand(std::function<void()> errand) { adjusting_.AddErrand(std::move(errand)); }
  int backlog() const { return mapping_.backlog(); }  // keyframes queued or being mapped
  // Calls finish(). `limit` seconds after the start, or with CutShort(), cut() becomes true, and
  // Drain() returns early until the end of finish().
  void FinishWithin(double limit, const std::function<void()>& finish);
  // Returns when no work is left; maps get a full adjustment if any keyframe was added since the
  // last call. When cut() becomes true, drops the remaining work and returns as soon as work in
  // progress has ended. Does not throw what a worker throws; see health().
  void Drain();
  bool cut() const { return cut_short_; }
  // Cuts the running FinishWithin() short, or else the next one; any thread.
  void CutShort();
  void Restore(const SavedMap& saved);  // before the first keyframe
  void BeginRecording();                // the times of keyframes from now on are of another clock
  // Removes a map and its places. Threaded: returns earlier; the loop closer's thread removes it.
  void Drop(MapId id);
  std::vector<MapId> dropped() const;  // maps given to Drop() that are not removed yet
  WorkerNews TakeNews();               // returns each item once

  // Any thread may call these.
  std::vector<StageHealth> health() const;
  // Whether keyframes may be added: mapping is on and has not failed.
  bool MayMap() const { return mapping_on_ && mapping_.failure() == nullptr; }
  bool any_stopped() const;
  int loops() const { return loop_closer_.loops(); }
  int merges() const { return loop_closer_.merges(); }
  SemiDenseReport SemiDense() const { return semidense_mapper_.report(); }
  const SampleLog& map_milliseconds() const { return mapping_.milliseconds(); }
  const SampleLog& loop_milliseconds() const { return looping_.milliseconds(); }
  const SampleLog& semidense_milliseconds() const { return semidense_.milliseconds(); }

 private:
  void MapKeyFrame(KeyFrameId id, const std::atomic<bool>* stop);
  void Map(KeyFrameId id, const std::atomic<bool>* stop);
  void Loop(KeyFrameId id);
  void CutNow();
  void AdjustAll(KeyFrameId id, const std::atomic<bool>* stop);
  void WhileAllRest(const std::function<void()>& action);

  MapStore map_;
  PlaceIndex places_;
  Mapper mapper_;
  ReadoutWatch readout_watch_;  // used by mapping_
  LensWatch lens_watch_;        // used by mapping_
  LoopCloser loop_closer_;
  SemiDenseMapper semidense_mapper_;
  bool dense_;        // semi-dense mapping is on
  const bool waits_;  // SlamSettings::wait_for_mapping
  std::atomic<bool> mapping_on_;
  std::mutex cut_mutex_;
  bool finishing_ = false;              // FinishWithin() is running
  bool cut_next_ = false;               // CutShort() was called before it
  std::atomic<bool> cut_short_{false};  // true only while finishing_
  std::mutex news_mutex_;
  std::vector<MapId> unknown_scale_;  // WorkerNews::unknown_scale
  bool limit_told_ = false;      // the user was warned of mapper.max_keyframes; used by mapping_
  uint32_t adjusted_up_to_ = 0;  // MapSnapshot::next_keyframe() at the last adjustment by Drain()
  mutable std::mutex dropped_mutex_;
  std::vector<MapId> dropped_;  // see dropped()
  Stage adjusting_, looping_, semidense_, mapping_;
};

}  // namespace alidade
