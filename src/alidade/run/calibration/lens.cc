#include "alidade/run/calibration/lens.h"

#include <cmath>
#include <cstdio>
#include <new>

#include "alidade/map/view.h"
#include "alidade/run/setup/setting_group.h"

namespace alidade {
namespace {

// `s` is a LensSettings, const or not.
constexpr auto kLensFields = [](auto& s, auto&& visit) {
  visit("lens.window", s.window);
  visit("lens.least_window", s.least_window);
  visit("lens.min_windows", s.min_windows);
  visit("lens.max_windows", s.max_windows);
  visit("lens.min_seen", s.min_seen);
  visit("lens.min_bend", s.min_bend);
  visit("lens.min_sigmas", s.min_sigmas);
};

}  // namespace

void LensSettings::Set(const std::string& name, const std::string& value) {
  SetByName(*this, kLensFields, name, value);
}

std::vector<std::pair<std::string, std::string>> LensSettings::All() const {
  return AllByName(*this, kLensFields);
}

LensCheck CheckLens(const Slam& slam, const SlamSettings& used, const LensSettings& settings) {
  if (used.localise) return {};
  try {
    const MapSnapshot map = slam.Snapshot();
    const MapId largest = LargestMap(map);
    MeasurementNoise noise = used.mapper.noise;
    noise.right_from_sensor = slam.camera().baseline <= 0;
    return largest.valid() ? CheckLens(map, largest, slam.camera(), noise, settings) : LensCheck{};
  } catch (const std::bad_alloc&) {  // results matter more
    return {};
  }
}

std::string LensInWords(const LensCheck& check, const Camera& camera) {
  if (!check.strong) return "";
  char how[80];
  std::snprintf(how, sizeof(how), " (k1 near %.2f, by %.0f %% at the picture's corners)", check.k1,
                100 * std::abs(check.bend));
  const std::string than =
      camera.HasDistortion() ? " more strongly than its calibration says" : " strongly";
  return "this camera's lens bends lines" + than + how +
         ": the path and the map are bent with it. Give its calibration, distortion included, with "
         "--camera (docs/reference/camera.md)";
}

}  // namespace alidade
