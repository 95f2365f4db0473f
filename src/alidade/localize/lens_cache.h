// The conversions of pictures of the cameras that were used last.
#pragma once

#include <list>
#include <mutex>
#include <utility>

#include "alidade/io/calibration.h"

namespace alidade {

// A fisheye's rectification takes longer to compute than a picture to localize; a client sends many
// pictures of one camera. Thread-safe.
class LensCache {
 public:
  static constexpr size_t kMost = 8;  // cameras; the one that was used least recently is dropped

  // ImagePreparation of the left camera alone. Throws Error as that does.
  ImagePreparation Of(const Calibration& calibration);

 private:
  std::mutex mutex_;
  std::list<std::pair<RawCamera, ImagePreparation>> known_;  // used last first; guarded by mutex_
};

}  // namespace alidade
