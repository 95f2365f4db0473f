#include "alidade/base/part_times.h"

#include <utility>

namespace alidade {

constinit thread_local PartTimes* PartTimer::listening = nullptr;

const char* NameOf(FramePart part) {
  constexpr const char* kNames[kFrameParts] = {
      "news",       "prepare",   "inertial",     "movers",  "buffers", "pyramid",  "smooth",
      "corners",    "spread",    "describe",     "grid",    "depth",   "glance",   "align",
      "last frame", "local map", "local search", "passing", "pose",    "evidence", "shutter",
      "place",      "keyframe",  "left out",     "publish", "earlier", "mapping",  "other"};
  return kNames[static_cast<int>(part)];
}

PartTimes::PartTimes() { PartTimer::listening = this; }

PartTimes::~PartTimes() { PartTimer::listening = nullptr; }

FramePart PartTimes::Switch(FramePart part) {
  const Clock::time_point now = Clock::now();
  milliseconds_[static_cast<int>(running_)] +=
      std::chrono::duration<double, std::milli>(now - since_).count();
  since_ = now;
  return std::exchange(running_, part);
}

std::array<double, kFrameParts> PartTimes::Take() {
  Switch(running_);
  return std::exchange(milliseconds_, {});
}

}  // namespace alidade
