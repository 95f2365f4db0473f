#include "bench/wild_cases.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade::bench {
namespace {

std::vector<WildCase> AllCases() {
  return {
      {"room", "synth:room?frames=240"},
      {"room-phone", "synth:room?frames=240", "phone"},
      {"desk", "synth:desk?frames=240"},
      {"desk-phone", "synth:desk?frames=240", "phone"},
      {"desk-small", "synth:desk?frames=240&width=320&height=240"},
      {"wall", "synth:wall?frames=240"},
      {"corridor", "synth:corridor?frames=500&fps=15"},
      {"rooms", "synth:loop?frames=320&fps=10"},
      {"room-10hz", "synth:room?frames=190&fps=10"},
      {"room-3hz", "synth:room?frames=66&fps=3.5"},
      {"room-upright", "synth:room?frames=240&width=360&height=640&fov=40&calibrated=0"},
      {"turn", "synth:room?path=turn&frames=300", "desktop", false},
      {"turn-upright", "synth:room?path=turn&frames=300&width=360&height=640&fov=37&calibrated=0",
       "desktop", false},
      {"turn-unknown", "synth:room?path=turn&frames=300&fov=75&calibrated=0", "desktop", false},
      {"turn-walk", "synth:room?path=turn-walk&frames=300"},
      {"turn-arm", "synth:room?path=turn&arm=0.4&frames=300"},
      {"still-cup", "synth:desk?path=still&things=1&frames=240", "desktop", false},
      {"still-cups", "synth:desk?path=still&things=3&frames=240&fov=50&calibrated=0", "desktop",
       false},
      {"still-person", "synth:room?path=still&actors=1&frames=240", "desktop", false},
      {"still-people", "synth:room?path=still&actors=3&frames=240", "desktop", false},
      {"people", "synth:room?frames=240&actors=3"},
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
