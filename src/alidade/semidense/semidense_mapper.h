// Inverse depth at the high-gradient pixels of each keyframe (Mur-Artal & Tardós, RSS 2015), a few
// keyframes behind the mapper. One instance, one thread at a time, but for Keep() and report().
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
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

  // The picture of a keyframe just inserted. Thread-safe, and quick.
  void Keep(KeyFrameId id, std::shared_ptr<const Picture> picture);

  // A keyframe was mapped: works on the one whose turn it is now, the newest first, and commits its
  // depth; where none waits, or a loop was closed, on one whose neighbours have moved since.
  void Process();

  // Nothing will follow: works on all that wait or were moved, and checks every keyframe's depth
  // against its neighbours', of which only the older ones were known before.
  // `stop` (may be null): turns true when it is enough; the map is sound then, and some keyframes
  // stay without depth, or unchecked.
  void Finish(const std::atomic<bool>* stop = nullptr);

  // The map is of this camera from now on: all depth is found anew, a keyframe at a time. Nothing
  // else may be at work.
  void SetCamera(const Camera& camera);

  SemiDenseReport report() const;  // of all that is done; any thread may ask

 private:
  struct Entry;
  MapSnapshot TakeIn();         // what was kept, and out what is not in the map (returned) any more
  void LetGo(int turned_away);  // of those that wait, the oldest beyond max_waiting
  Entry* Find(KeyFrameId id);
  Entry* NextDue(const MapSnapshot& map);
  Entry* NewestMoved(const MapSnapshot& map);
  bool Moved(const MapSnapshot& map, const Entry& entry) const;
  void CountBytes(const MapSnapshot& map);
  void Tell();
  void WorkOn(const MapSnapshot& map, Entry& entry);
  void Estimate(const MapSnapshot& map, Entry& entry);
  std::vector<DepthView> Views(const MapSnapshot& map, const KeyFrame& keyframe);
  std::shared_ptr<const DepthMap> Checked(const MapSnapshot& map, const Entry& entry);

  MapStore& map_;
  Camera camera_;
  SemiDenseSettings settings_;
  GradientImageMaker maker_;
  std::mutex inbox_mutex_;
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Picture>>> inbox_;
  int turned_away_ = 0;                          // pictures, since the inbox was last emptied
  std::vector<std::unique_ptr<Entry>> entries_;  // by id
  uint64_t settled_corrections_ = 0;  // of the map, up to which all that moved was done again
  SemiDenseReport report_;
  mutable std::mutex told_mutex_;
  SemiDenseReport told_;  // report_ as of the last keyframe that was done
};

}  // namespace alidade
