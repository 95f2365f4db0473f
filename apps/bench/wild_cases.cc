#include "bench/wild_cases.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade::bench {
namespace {

constexpr char kPhone[] = "phone";

WildCase NoMap(const std::string& name, const std::string& source) {
  return {name, source, "desktop", false};
}

std::vector<WildCase> AllCases() {
  return {
      // As it should be, and nothing is the matter.
      {"room", "synth:room?frames=240"},
      {"room-phone", "synth:room?frames=240", kPhone},
      {"desk", "synth:desk?frames=240"},
      {"desk-phone", "synth:desk?frames=240", kPhone},
      {"desk-small", "synth:desk?frames=240&width=320&height=240"},
      {"wall", "synth:wall?frames=240"},
      {"table", "synth:table?frames=300"},
      // Walks.
      {"corridor", "synth:corridor?frames=500&fps=15"},
      {"rooms", "synth:loop?frames=320&fps=10"},
      {"blank", "synth:blank?frames=400"},  // turns past the blank wall from frame 190 to 330
      {"hall", "synth:hall?frames=420&fps=15"},
      // A phone held upright, and a camera that nobody knows.
      {"room-upright", "synth:room?frames=240&width=360&height=640&fov=37&calibrated=0"},
      {"desk-unknown", "synth:desk?frames=240&fov=80&calibrated=0"},
      {"room-lens", "synth:room?frames=240&k1=-0.24&calibrated=0"},
      {"room-fisheye", "synth:room?frames=240&fisheye&fov=110&calibrated=0"},
      // Few frames a second.
      {"room-10hz", "synth:room?frames=190&fps=10"},
      {"room-3hz", "synth:room?frames=66&fps=3.5"},
      {"desk-10hz", "synth:desk?frames=150&fps=10"},
      // What sensors do.
      {"room-dark", "synth:room?frames=240&light=0.06&exposure"},
      {"desk-blur", "synth:desk?frames=240&blur=33&speed=1.5"},
      {"room-rolling", "synth:room?frames=240&rolling_shutter=30&speed=1.5"},
      // Driving.
      {"street", "synth:street?frames=250&fps=10"},
      {"street-phone", "synth:street?frames=250&fps=10", kPhone},
      {"street-3hz", "synth:street?frames=120&fps=3.5"},
      {"road", "synth:road?frames=250&fps=10"},
      {"road-phone", "synth:road?frames=250&fps=10", kPhone},
      // Turns on the spot: exact ones give no map, whatever is thought of the camera.
      NoMap("turn", "synth:room?path=turn&frames=300"),
      NoMap("turn-narrow", "synth:room?path=turn&frames=300&fov=45&calibrated=0"),
      NoMap("turn-wide", "synth:room?path=turn&frames=300&fov=85&calibrated=0"),
      NoMap("turn-upright",
            "synth:room?path=turn&frames=300&width=360&height=640&fov=33&calibrated=0"),
      NoMap("turn-10hz", "synth:room?path=turn&frames=150&fps=10&rolling_shutter=30"),
      {"turn-walk", "synth:room?path=turn-walk&frames=300"},
      {"turn-arm", "synth:room?path=turn&arm=0.4&frames=300"},
      // What moves by itself.
      {"people", "synth:room?frames=240&actors=3"},
      NoMap("still-cup", "synth:table?path=still&things=1&frames=240&fov=45"),
      NoMap("still-cups", "synth:table?path=still&things=2&frames=240&fov=45&calibrated=0"),
      NoMap("still-desk", "synth:desk?path=still&things=3&frames=240&fov=50&calibrated=0"),
      NoMap("still-person", "synth:room?path=still&actors=1&frames=240"),
      NoMap("still-people", "synth:table?path=still&actors=3&frames=240"),
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
