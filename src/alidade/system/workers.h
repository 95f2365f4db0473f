// The map and all that works on it behind the tracker: mapper, loop closer, full adjustment, each
// as a stage. Keyframes pass through them in this order.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "alidade/looping/loop_closer.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/mapper.h"
#include "alidade/place/place_index.h"
#include "alidade/semidense/semidense_mapper.h"
#include "alidade/system/health.h"
#include "alidade/system/lens_watch.h"
#include "alidade/system/readout_watch.h"
#include "alidade/system/settings.h"
#include "alidade/system/stage.h"

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

  void Add(KeyFrameId id) { mapping_.Add(id); }  // to be mapped, then looked for elsewhere
  void AddMapped(KeyFrameId id);                 // needs no mapping
  // The keyframe's picture, before it is added: semi-dense mapping wants a copy. Null without it.
  void Keep(KeyFrameId id, const Picture* picture);
  // How long the camera's shutter takes to roll, as found by now; see Camera::readout.
  std::array<double, 2> readout() const { return readout_watch_.readout(); }
  ReadoutWatch& readout_watch() { return readout_watch_; }
  double readout_sigma() const { return readout_watch_.sigma(); }
  void AskForCamera();                       // what the map says of its lens, now: see LensWatch
  void AskAnew();                            // the map that was asked is gone
  void AwaitMapping() { mapping_.Drain(); }  // of the keyframes handed over so far
  void AwaitDrop() { looping_.Drain(); }     // until maps that were to be dropped are out
  LensWatch& lens_watch() { return lens_watch_; }
  const LensWatch& lens_watch() const { return lens_watch_; }
  // All maps are of another camera from now on: each is bent to it and adjusted, while nothing else
  // is at work. The tracker's thread; not while keyframes of it wait.
  void ChangeCamera(const Camera& from, const Camera& to);
  int backlog() const { return mapping_.backlog(); }  // keyframes that wait for the mapper
  // Until nothing is left to do; what grew is adjusted as a whole once more. After `limit` seconds,
  // or CutShort(), what is left is given up, as soon as what is in work can be brought to an end.
  // What a worker throws does not come out here: see health().
  void Drain(double limit = std::numeric_limits<double>::infinity());
  void CutShort();                      // any thread's: a Drain() that runs, or else the next
  void Restore(const SavedMap& saved);  // before the first keyframe
  void BeginRecording();  // keyframes from now on are of another clock. The tracker's thread
  // A map and its places, without a trace. Not awaited when threaded.
  void Drop(MapId id);
  std::vector<MapId> dropped() const;  // and not out of the map yet
  WorkerNews TakeNews();               // each item once

  // Any thread may ask.
  std::vector<StageHealth> health() const;
  bool mapping_stopped() const { return mapping_.failure() != nullptr; }
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
  void DrainStages();
  void AdjustAll(KeyFrameId id, const std::atomic<bool>* stop);
  void WhileAllRest(const std::function<void()>& action);

  MapStore map_;
  PlaceIndex places_;
  Mapper mapper_;
  ReadoutWatch readout_watch_;  // mapping_'s
  LensWatch lens_watch_;        // likewise
  LoopCloser loop_closer_;
  SemiDenseMapper semidense_mapper_;
  bool dense_;  // semi-dense mapping is asked for
  std::atomic<bool> cut_short_{false};
  std::mutex news_mutex_;
  std::vector<MapId> unknown_scale_;  // WorkerNews::unknown_scale
  bool limit_told_ = false;           // that keyframes go because there are too many; mapping_'s
  uint32_t adjusted_up_to_ = 0;       // keyframes there were at the last adjustment of Drain()
  mutable std::mutex dropped_mutex_;
  std::vector<MapId> dropped_;  // given up, and not out of the map yet
  Stage adjusting_, looping_, semidense_, mapping_;
};

}  // namespace alidade
