// The line that shows how far a run is.
#pragma once

#include "alidade/base/timing.h"
#include "alidade/system/slam.h"
#include "terminal.h"

namespace alidade {

class RunProgress {
 public:
  RunProgress(Terminal& terminal, int total) : terminal_(terminal), total_(total) {}  // -1: unknown
  ~RunProgress() { terminal_.SetProgress(""); }
  RunProgress(const RunProgress&) = delete;
  RunProgress& operator=(const RunProgress&) = delete;

  void Show(int frames, TrackState state, const Slam& slam);
  void ShowFinishing(const Slam& slam);  // the last frame is in, the workers are not done

 private:
  Terminal& terminal_;
  const int total_;
  Stopwatch clock_;
  double shown_at_ = -1e9;  // ms
  int shown_frames_ = 0;
  double fps_ = 0;  // smoothed
};

}  // namespace alidade
