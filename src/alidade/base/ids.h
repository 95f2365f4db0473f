// Typed ids of map objects. They are issued in increasing order and never reused.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

template <typename Tag>
struct Id {
  static constexpr uint32_t kNone = 0xffffffffu;
  uint32_t value = kNone;

  constexpr bool valid() const { return value != kNone; }
  friend constexpr bool operator==(Id a, Id b) { return a.value == b.value; }
  friend constexpr auto operator<=>(Id a, Id b) { return a.value <=> b.value; }
};

using KeyFrameId = Id<struct KeyFrameTag>;
using LandmarkId = Id<struct LandmarkTag>;
using MapId = Id<struct MapTag>;  // of a part of the map that has its own world frame

}  // namespace alidade

template <typename Tag>
struct std::hash<alidade::Id<Tag>> {
  size_t operator()(alidade::Id<Tag> id) const { return std::hash<uint32_t>()(id.value); }
};
