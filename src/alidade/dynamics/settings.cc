#include "alidade/dynamics/settings.h"

#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade {

bool LeavesOutFromStart(DynamicsMode mode) {
  return mode == DynamicsMode::kGeometry || mode == DynamicsMode::kFull;
}

const char* NameOf(DynamicsMode mode) {
  switch (mode) {
    case DynamicsMode::kOff:
      return "off";
    case DynamicsMode::kAuto:
      return "auto";
    case DynamicsMode::kGeometry:
      return "geometry";
    case DynamicsMode::kFull:
      break;
  }
  return "full";
}

DynamicsMode DynamicsModeNamed(const std::string& what, const std::string& word) {
  std::vector<std::string> names;
  for (DynamicsMode mode :
       {DynamicsMode::kOff, DynamicsMode::kAuto, DynamicsMode::kGeometry, DynamicsMode::kFull}) {
    if (word == NameOf(mode)) return mode;
    names.push_back(NameOf(mode));
  }
  ThrowUsage(what + " cannot be '" + word + "' (it is one of off, auto, geometry, full)" +
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
  require(watch_mean >= 1, "watch_mean must be at least 1");
  require(watch_moved > 0 && watch_moved_depth > 0,
          "watch_moved and watch_moved_depth must be positive");
  require(watch_frames > votes.agreement_ago, "watch_frames must exceed votes.agreement_ago");
  require(watch_mean <= watch_frames, "watch_mean must be at most watch_frames");
  require(watch_every >= watch_frames, "watch_every must be at least watch_frames");
  require(watch_lens >= 0, "watch_lens must not be negative");
  require(watch_rival_frames >= 1, "watch_rival_frames must be at least 1");
  require(detector_every_frames >= 1, "detector_every_frames must be at least 1");
  require(detector_latency_frames >= 0 && detector_latency_frames <= 30,
          "detector_latency_frames must be from 0 to 30");
  require(detector_rest >= 0 && detector_rest <= 100, "detector_rest must be from 0 to 100");
  require(drop_detections >= 0 && drop_detections <= 1, "drop_detections must lie in [0, 1]");
  require(bridge_seconds >= 0, "bridge_seconds must not be negative");
}

}  // namespace alidade
