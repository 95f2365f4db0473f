// The output of `alidade run`: progress line, warnings and summary.
#pragma once

#include <optional>

#include "alidade/base/timing.h"
#include "alidade/run/play/watcher.h"
#include "program/terminal.h"

namespace alidade {

class RunProgress : public RunWatcher {
 public:
  explicit RunProgress(bool quiet) : terminal_(quiet), quiet_(quiet) {}

  void Begin(const WatchedRun& run, const std::string& folder) override;
  void Calibrating(const CalibrateProgress& progress) override;
  void Frame(const SourceFrame& frame, const TrackResult& result) override;
  void Finishing() override;
  void Finished() override { terminal_.SetProgress(""); }
  void End(const RunSummary& summary, const std::string& folder) override;
  void Warn(const std::string& message) override { terminal_.Warn(message); }

 private:
  Terminal terminal_;
  const bool quiet_;
  std::optional<WatchedRun> run_;
  Stopwatch clock_;
  double shown_at_ = -1e9;  // ms
  int shown_frames_ = 0;
  double fps_ = 0;  // smoothed
};

}  // namespace alidade
