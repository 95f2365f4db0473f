#include "bench/wild/cases.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade::bench {
namespace {

constexpr char kPhone[] = "phone";
// Where nothing else is said: 4:3, 62.7 degrees, which the program is told.
constexpr char kSize[] = "&width=480&height=360";
// A phone held upright, 9:16.
constexpr char kUpright[] = "&width=288&height=512&calibrated=0";

WildCase Map(const std::string& name, const std::string& source,
             const std::string& profile = "desktop") {
  const bool sized = source.find("width=") != std::string::npos;
  return {name, "synth:" + source + (sized ? "" : kSize), profile, true};
}

WildCase NoMap(const std::string& name, const std::string& source) {
  WildCase of = Map(name, source);
  of.map = false;
  return of;
}

std::vector<WildCase> AllCases() {
  const std::string upright = kUpright;
  return {
      // Nothing is the matter.
      Map("room", "room?frames=200"),
      Map("room-phone", "room?frames=200", kPhone),
      Map("desk", "desk?frames=200"),
      Map("desk-phone", "desk?frames=200", kPhone),
      Map("desk-small", "desk?frames=200&width=320&height=240"),
      Map("wall", "wall?frames=200"),
      Map("table", "table?frames=200"),
      // Walks.
      Map("corridor", "corridor?frames=500&fps=15"),
      Map("rooms", "loop?frames=320&fps=10"),
      Map("blank", "blank?frames=280&fps=20"),  // past the blank wall from frame 125 to 220
      Map("hall", "hall?frames=420&fps=15"),
      // A phone held upright, and cameras that nobody knows.
      Map("room-upright", "room?frames=200&fov=37" + upright),
      Map("desk-unknown", "desk?frames=200&fov=80&calibrated=0"),
      Map("room-lens", "room?frames=200&k1=-0.24&calibrated=0"),
      Map("room-fisheye", "room?frames=200&fisheye&fov=110&calibrated=0"),
      // Few frames a second.
      Map("room-10hz", "room?frames=190&fps=10"),
      Map("room-3hz", "room?frames=66&fps=3.5"),
      Map("desk-10hz", "desk?frames=150&fps=10"),
      // Busy phones.
      Map("room-held", "room?frames=200&fps=15&held=0.04"),
      Map("rooms-held", "loop?frames=320&fps=10&held=0.04"),
      // What sensors do.
      Map("room-dark", "room?frames=200&light=0.06&exposure"),
      Map("desk-blur", "desk?frames=200&blur=33&speed=1.5"),
      Map("room-rolling", "room?frames=200&rolling_shutter=30&speed=1.5"),
      // Driving.
      Map("street", "street?frames=200&fps=10"),
      Map("street-phone", "street?frames=200&fps=10", kPhone),
      Map("street-3hz", "street?frames=120&fps=3.5"),
      Map("road", "road?frames=200&fps=10"),
      Map("road-phone", "road?frames=200&fps=10", kPhone),
      // Turns on the spot: exact ones give no map, whatever is thought of the camera.
      NoMap("turn", "room?path=turn&frames=160&fps=15"),
      NoMap("turn-narrow", "room?path=turn&frames=160&fps=15&fov=45&calibrated=0"),
      NoMap("turn-wide", "room?path=turn&frames=160&fps=15&fov=85&calibrated=0"),
      NoMap("turn-upright", "room?path=turn&frames=160&fps=15&fov=33" + upright),
      NoMap("turn-10hz", "room?path=turn&frames=120&fps=10&rolling_shutter=30"),
      Map("turn-walk", "room?path=turn-walk&frames=220&fps=20"),
      Map("turn-arm", "room?path=turn&arm=0.4&frames=160&fps=15"),
      // What moves by itself.
      Map("people", "room?frames=200&actors=3"),
      NoMap("still-cup", "table?path=still&things=1&frames=150&fov=45"),
      NoMap("still-cups", "table?path=still&things=2&frames=150&fov=45&calibrated=0"),
      NoMap("still-desk", "desk?path=still&things=3&frames=150&fov=50&calibrated=0"),
      NoMap("still-person", "room?path=still&actors=1&frames=150"),
      NoMap("still-people", "table?path=still&actors=3&frames=150"),
  };
}

std::vector<std::string> Split(const std::string& names) {
  std::vector<std::string> words;
  for (size_t at = 0; at <= names.size();) {
    const size_t end = std::min(names.find(',', at), names.size());
    if (end > at) words.push_back(names.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

}  // namespace

std::vector<WildCase> WildCases(const std::string& names) {
  std::vector<WildCase> all = AllCases(), chosen;
  const std::vector<std::string> words = Split(names);
  if (words.empty()) return all;
  std::vector<std::string> known;
  for (const WildCase& each : all) known.push_back(each.name);
  for (const std::string& word : words) {
    const auto found = std::find(known.begin(), known.end(), word);
    if (found == known.end())
      ThrowUsage("--cases: there is no case \"" + word + "\"" + DidYouMean(word, known));
    chosen.push_back(all[static_cast<size_t>(found - known.begin())]);
  }
  return chosen;
}

}  // namespace alidade::bench
