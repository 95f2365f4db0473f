// Interface of observers of a run: progress on a terminal, the viewer, the recorder. They do not
// influence results.
#pragma once

#include <string>

#include "alidade/io/frame_source.h"
#include "alidade/run/calibration/find_camera.h"
#include "alidade/run/outputs.h"
#include "alidade/run/results/record.h"
#include "alidade/system/slam.h"

namespace alidade {

// Called from the thread that plays the frames, except Warn().
class RunWatcher {
 public:
  virtual ~RunWatcher() = default;
  // During offline self-calibration, before Begin(): after each frame of a pass.
  virtual void Calibrating(const CalibrateProgress& progress) { (void)progress; }
  // Before the first frame. `slam` and `record` remain valid until End() has returned or Run()
  // throws. `folder` exists and collects the files; a watcher may write its own files into it until
  // Written() has returned.
  virtual void Begin(const Slam& slam, const RunRecord& record, const std::string& folder) {
    (void)slam, (void)record, (void)folder;
  }
  // Before each frame; may block to pause the run. `interrupted` returns true when it must return.
  virtual void Wait(bool (*interrupted)()) { (void)interrupted; }
  // After each frame that Track() has processed.
  virtual void Frame(const SourceFrame& frame, const TrackResult& result) {
    (void)frame, (void)result;
  }
  virtual void Finishing() {}  // waiting for the workers
  virtual void Finished() {}   // the map is final
  // All files except the watchers' own are in `folder` (that of Begin()), before they are moved to
  // their place.
  virtual void Written(const std::string& folder) { (void)folder; }
  // All files that could be written are in `folder`.
  virtual void Placed(const std::string& folder) { (void)folder; }
  // The results are in `folder`, their final place.
  virtual void End(const RunSummary& summary, const std::string& folder) {
    (void)summary, (void)folder;
  }
  virtual void Warn(const std::string& message) { (void)message; }  // from any thread
};

}  // namespace alidade
