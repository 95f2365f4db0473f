// Semi-dense mapping: inverse depth at the high-gradient pixels of each keyframe (Mur-Artal &
// Tardós, RSS 2015), a few keyframes behind the mapper. One thread at a time, except for Keep() and
// report().
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "alidade/features/picture.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/depth_view.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/report.h"
#include "alidade/semidense/settings.h"

namespace alidade {

class SemiDenseMapper {
 public:
  SemiDenseMapper(MapStore& map, const Camera& camera, const SemiDenseSettings& settings);
  ~SemiDenseMapper();

  // Stores the picture of a newly inserted keyframe. Thread-safe and fast.
  void Keep(KeyFrameId id, std::shared_ptr<const Picture> picture);

  // Called after a keyframe was mapped. Processes the newest keyframe that is due and commits its
  // depth; if none is due, or a loop was closed, processes one whose neighbors have moved.
  void Process();

  // Called at the end of input. Processes all keyframes that are due or were moved, and checks
  // every keyframe's depth against all neighbors (before, only older ones were available). `stop`
  // (may be null) ends it early; the map is then consistent, but some keyframes have no depth or
  // are not checked.
  void Finish(const std::atomic<bool>* stop = nullptr);

  // Changes the camera model of the map: all depth is recomputed, one keyframe at a time. No other
  // thread may be using the map.
  void SetCamera(const Camera& camera);

  SemiDenseReport report() const;  // statistics so far; thread-safe

 private:
  struct Entry;
  // Moves new pictures to entries_ and drops entries of keyframes that are not in the map
  // (returned) any more.
  MapSnapshot TakeIn();
  void LetGo(int turned_away);  // drops the oldest waiting entries beyond max_waiting
  Entry* Find(KeyFrameId id);
  Entry* NextDue(const MapSnapshot& map);
  Entry* NewestMoved(const MapSnapshot& map);
  bool Moved(const MapSnapshot& map, const Entry& entry) const;
  void CountBytes(const MapSnapshot& map);
  void Tell();
  void WorkOn(const MapSnapshot& map, Entry& entry);
  // `views`: Views() of the keyframe.
  void Estimate(const MapSnapshot& map, Entry& entry, std::span<const DepthView> views);
  std::vector<DepthView> Views(const MapSnapshot& map, const KeyFrame& keyframe);
  std::shared_ptr<const DepthMap> Checked(const MapSnapshot& map, const Entry& entry,
                                          std::span<const DepthView> views);

  MapStore& map_;
  Camera camera_;
  SemiDenseSettings settings_;
  GradientImageMaker maker_;
  std::mutex inbox_mutex_;
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Picture>>> inbox_;
  int turned_away_ = 0;  // pictures dropped since the inbox was last emptied
  std::vector<std::unique_ptr<Entry>> entries_;  // by id
  // MapSnapshot::corrections() up to which all moved keyframes were redone.
  uint64_t settled_corrections_ = 0;
  SemiDenseReport report_;
  mutable std::mutex told_mutex_;
  SemiDenseReport told_;  // copy of report_ after the last processed keyframe
};

}  // namespace alidade
