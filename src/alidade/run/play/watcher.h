// Interface of observers of a run: progress on a terminal, the viewer, the recorder. They influence
// results by what they ask for only (RunWatcher::Asked()).
#pragma once

#include <optional>
#include <string>

#include "alidade/io/frame_source.h"
#include "alidade/run/calibration/camera_finding.h"
#include "alidade/run/results/run_log.h"
#include "alidade/run/results/run_summary.h"
#include "alidade/run/setup/run_setup.h"
#include "alidade/system/slam.h"

namespace alidade {

// A run as its watchers see it: all of it lives until End() has returned, or Run() throws.
struct WatchedRun {
  const Slam& slam;
  const RunSetup& setup;
  const CameraFinding& camera;
  const RunLog& log;
  std::string place;  // where the result folder will be
};

// What the user of a watcher asks of a run that goes on.
struct RunRequest {
  bool forget = false;          // Slam::Forget(); with RunOptions::localize Slam::Reset()
  std::optional<bool> mapping;  // Slam::SetMapping()
};

// Called from the thread that plays the frames, except Warn().
class RunWatcher {
 public:
  virtual ~RunWatcher() = default;
  // During offline self-calibration, before Begin(): after each frame of a pass.
  virtual void Calibrating(const CalibrateProgress& progress) { (void)progress; }
  // Before the first frame. Files are gathered in `folder`, which is there; a watcher may write its
  // own into it until Written() has returned.
  virtual void Begin(const WatchedRun& run, const std::string& folder) { (void)run, (void)folder; }
  // Before each frame: may hold the run up for as long as it should pause. `interrupted` says when
  // it must not any more.
  virtual void Wait(bool (*interrupted)()) { (void)interrupted; }
  // Before each frame: what was asked for since the last call.
  virtual RunRequest Asked() { return {}; }
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
