// Makes the newest map anew from the kept frames, as a second pass over the images would. Used by
// the driving thread.
#pragma once

#include <functional>

#include "alidade/system/present_frame.h"
#include "alidade/system/revisit/early_frames.h"
#include "alidade/system/revisit/kept_frames.h"
#include "alidade/system/session.h"
#include "alidade/system/start/young_map.h"
#include "alidade/system/types.h"
#include "alidade/system/workers/workers.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

struct MapReplayParts {
  Workers& workers;
  Session& session;
  YoungMap& young;
  EarlyFrames& early;
  KeptFrames& kept;
  Tracker& tracker;
  bool one_camera;  // without depth: frames are localized again later
};

class MapReplay {
 public:
  // Processes a kept frame as if it were the present one.
  using Process = std::function<TrackResult(PresentFrame&)>;
  MapReplay(const MapReplayParts& parts, Process process)
      : parts_(parts), process_(std::move(process)) {}

  // The tracker is in the newest map, all of whose frames are kept, and fewer than three maps were
  // made anew.
  bool Possible() const;
  // Drops that map, calls `change`, and processes the kept frames, each changed by `adapt`.
  // The images are gone, so keyframes among these frames have no dense depth. If memory runs out,
  // the map ends there and goes on with new frames.
  void Run(const std::function<void()>& change, const std::function<void(Frame&)>& adapt);

 private:
  void Play(const KeptFrames::Kept& kept, const std::function<void(Frame&)>& adapt);

  MapReplayParts parts_;
  Process process_;
  int count_ = 0;
};

}  // namespace alidade
