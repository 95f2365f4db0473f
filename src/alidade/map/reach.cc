#include "alidade/map/reach.h"

#include <algorithm>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {
namespace {

// Highest speed in the last `span` seconds of the path, between positions at least 0.2 s apart so
// that their noise is negligible; nullopt if there are no two such positions.
std::optional<double> FastestOf(std::span<const TimedPlace> way, double span) {
  constexpr double kApart = 0.2;  // seconds
  std::optional<double> fastest;
  const TimedPlace* later = &way.back();
  for (size_t i = way.size() - 1; i-- > 0;) {
    const double seconds = later->time - way[i].time;
    if (seconds < kApart) continue;
    const double speed = (later->centre - way[i].centre).norm() / seconds;
    fastest = std::max(fastest.value_or(0), speed);
    later = &way[i];
    if (way.back().time - later->time >= span) break;
  }
  return fastest;
}

// Sum of `step` over consecutive keyframes between two keyframes of a map.
template <typename Step>
double SumBetween(const MapSnapshot& map, KeyFrameId a, KeyFrameId b, const Step& step) {
  double sum = 0;
  const KeyFrame* after = nullptr;
  const MapId in = map.MapOf(a);
  map.keyframes().ForEachFromLast([&](const KeyFrame& here) {
    if (here.id > std::max(a, b) || here.map != in) return true;
    if (here.id < std::min(a, b)) return false;
    if (after) sum += step(here, *after);
    after = &here;
    return true;
  });
  return sum;
}

}  // namespace

std::span<const Setting> ReachSettings::Table() {
  using T = ReachSettings;
  static constexpr Setting kRows[] = {
      ExpertSetting<&T::speed>(
          "loop.reach.speed", kNotNegative, "",
          "A lost camera moves at most this times the highest speed it had just before."),
      ExpertSetting<&T::depth_speed>("loop.reach.depth_speed", kNotNegative, "1/s",
                                     "Plus this share of the median depth per second."),
      ExpertSetting<&T::drift>(
          "loop.reach.drift", kNotNegative, "",
          "Plus this share of the path since the place was last seen: the drift of tracking."),
  };
  return kRows;
}

void ReachSettings::Check() const {
  CheckRanges(*this);
  const auto is_share = [](double value) { return value >= 0 && value <= 1; };
  if (!(span > 0) || !(floor >= 0) || !is_share(plain_share) || !is_share(plain_alike) ||
      !is_share(elsewhere_share))
    ThrowUsage("ReachSettings: span must be positive, floor not negative, shares from 0 to 1");
}

double DoubtOf(std::span<const TimedPlace> way, const TimedPlace& to, double depth, double gone,
               const ReachSettings& settings) {
  if (way.size() < 2 || !(way.back().time <= to.time)) return 0;
  const std::optional<double> fastest = FastestOf(way, settings.span);
  if (!fastest) return 0;
  const double seconds = to.time - way.back().time;
  const double speed = settings.speed * *fastest + settings.depth_speed * depth;
  const double reach = settings.floor * depth + speed * seconds + settings.drift * gone;
  const double moved = (to.centre - way.back().centre).norm();
  return moved < reach ? moved * moved / (reach * reach) : 1;
}

double WayBetween(const MapSnapshot& map, KeyFrameId a, KeyFrameId b) {
  return SumBetween(map, a, b, [](const KeyFrame& here, const KeyFrame& after) {
    return (after.Centre() - here.Centre()).norm();
  });
}

double TurnBetween(const MapSnapshot& map, KeyFrameId a, KeyFrameId b) {
  return SumBetween(map, a, b, [](const KeyFrame& here, const KeyFrame& after) {
    return RotationAngle(here.T_camera_world, after.T_camera_world);
  });
}

}  // namespace alidade
