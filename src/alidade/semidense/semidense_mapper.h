// Inverse depth at the high-gradient pixels of each keyframe (Mur-Artal & Tardós, RSS 2015), a few
// keyframes behind the mapper. One instance, one thread at a time, but for Keep().
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "alidade/features/picture.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/settings.h"

namespace alidade {

class SemiDenseMapper {
 public:
  SemiDenseMapper(MapStore& map, const Camera& camera, const SemiDenseSettings& settings);
  ~SemiDenseMapper();

  // The picture of a keyframe just inserted. Thread-safe, and quick.
  void Keep(KeyFrameId id, std::shared_ptr<const Picture> picture);

  // Keyframe `id` was mapped: works on the one whose turn it is now, and commits its depth. `stop`
  // (may be null): something else waits.
  void Process(KeyFrameId id, const std::atomic<bool>* stop = nullptr);

  // Nothing will follow: all that is left to do.
  void Finish();

 private:
  MapStore& map_;
  Camera camera_;
  SemiDenseSettings settings_;
  std::mutex inbox_mutex_;
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Picture>>> inbox_;
};

}  // namespace alidade
