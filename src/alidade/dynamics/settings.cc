#include "alidade/dynamics/settings.h"

#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade {

const char* NameOf(DynamicsMode mode) {
  return mode == DynamicsMode::kOff ? "off" : mode == DynamicsMode::kFull ? "full" : "geometry";
}

DynamicsMode DynamicsModeNamed(const std::string& what, const std::string& word) {
  std::vector<std::string> names;
  for (DynamicsMode mode : {DynamicsMode::kOff, DynamicsMode::kGeometry, DynamicsMode::kFull}) {
    if (word == NameOf(mode)) return mode;
    names.push_back(NameOf(mode));
  }
  ThrowUsage(what + " cannot be '" + word + "' (it is one of off, geometry, full)" +
             DidYouMean(word, names));
}

void DynamicsSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("dynamics.") + what);
  };
  detector.Check();
  depth.Check();
  history.Check();
  votes.Check();
  surfaces.Check();
  tracks.Check();
  objects.Check();
  box.Check();
  features.Check();
  landmarks.Check();
  require(detector_every_frames >= 1, "detector_every_frames must be at least 1");
  require(detector_latency_frames >= 0 && detector_latency_frames <= 30,
          "detector_latency_frames must be from 0 to 30");
  require(detector_rest >= 0 && detector_rest <= 100, "detector_rest must be from 0 to 100");
  require(drop_detections >= 0 && drop_detections <= 1, "drop_detections must lie in [0, 1]");
  require(bridge_seconds >= 0, "bridge_seconds must not be negative");
}

}  // namespace alidade
