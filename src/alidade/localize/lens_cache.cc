#include "alidade/localize/lens_cache.h"

#include <algorithm>

namespace alidade {
namespace {

bool SameLens(const RawCamera& a, const RawCamera& b) {
  return a.lens == b.lens && a.width == b.width && a.height == b.height && a.fx == b.fx &&
         a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.distortion == b.distortion;
}

}  // namespace

ImagePreparation LensCache::Of(const Calibration& calibration) {
  const auto find = [&] {
    return std::find_if(known_.begin(), known_.end(),
                        [&](const auto& known) { return SameLens(known.first, calibration.left); });
  };
  {
    const std::lock_guard lock(mutex_);
    const auto found = find();
    if (found != known_.end()) {
      known_.splice(known_.begin(), known_, found);
      return found->second;
    }
  }
  ImagePreparation made(calibration, Sensor::kMono);  // others need not wait for it
  const std::lock_guard lock(mutex_);
  if (find() == known_.end()) known_.emplace_front(calibration.left, made);
  if (known_.size() > kMost) known_.pop_back();
  return made;
}

}  // namespace alidade
