#include "run/run_progress.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "alidade/base/shell_quoted.h"
#include "alidade/run/calibration/find_camera.h"
#include "alidade/run/results/run_results.h"

namespace alidade {
namespace {

constexpr double kInterval = 200;  // ms between two updates

std::string Clock(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  char text[32];
  if (whole >= 3600) {
    std::snprintf(text, sizeof(text), "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof(text), "%ld:%02ld", whole / 60, whole % 60);
  }
  return text;
}

}  // namespace

void RunProgress::Begin(const WatchedRun& run, const std::string& folder) {
  (void)folder;
  run_.emplace(run);
  shown_at_ = -1e9;  // of finding the camera
  const bool camera_found = run.camera.found && run.camera.found->usable;
  if (quiet_ || (!camera_found && run.setup.source.told.empty())) return;
  terminal_.SetProgress("");
  if (!run.setup.source.told.empty()) std::printf("%s\n", run.setup.source.told.c_str());
  if (camera_found)
    std::printf("Camera estimated: %s\n", CameraInWords(run.camera.found->estimate).c_str());
  std::fflush(stdout);
}

void RunProgress::Calibrating(const CalibrateProgress& progress) {
  if (!terminal_.shows_progress()) return;
  const double now = clock_.Milliseconds();
  if (now - shown_at_ < kInterval) return;
  shown_at_ = now;
  std::string line = "calibrating the camera: pass " + std::to_string(progress.pass) + ", frame " +
                     std::to_string(progress.frames);
  if (progress.estimate.observations > 0) line += ", " + FovInWords(progress.estimate);
  terminal_.SetProgress(line);
}

void RunProgress::Frame(const SourceFrame& frame, const TrackResult& result) {
  (void)frame;
  if (!terminal_.shows_progress()) return;
  const double now = clock_.Milliseconds();
  if (now - shown_at_ < kInterval) return;
  const int frames = run_->log.frames, total = run_->setup.source.frames;  // -1: unknown
  if (shown_at_ >= 0) {
    const double fps = 1e3 * (frames - shown_frames_) / (now - shown_at_);
    fps_ = fps_ == 0 ? fps : 0.8 * fps_ + 0.2 * fps;
  }
  shown_at_ = now;
  shown_frames_ = frames;
  const MapSnapshot map = run_->slam.Snapshot();
  std::string line = "frame " + std::to_string(frames);
  if (total > 0) line += "/" + std::to_string(total);
  char rate[32];
  std::snprintf(rate, sizeof(rate), "  %.1f/s", fps_);
  if (fps_ > 0) line += rate;
  line += std::string("  ") + StateName(result.state) + "  " +
          std::to_string(map.keyframe_count()) + " keyframes  " +
          std::to_string(map.landmark_count()) + " landmarks";
  if (total > 0 && fps_ > 0) line += "  " + Clock((total - frames) / fps_) + " left";
  terminal_.SetProgress(line);
}

void RunProgress::Finishing() {
  if (!terminal_.shows_progress()) return;
  terminal_.SetProgress("finishing: " + std::to_string(run_->slam.Snapshot().keyframe_count()) +
                        " keyframes in the final adjustment");
}

void RunProgress::End(const RunSummary& summary, const std::string& folder) {
  if (quiet_) return;
  const SlamSettings& settings = run_->setup.settings.slam;
  std::string shape;
  if (summary.shape_points > 0) {
    shape = ", " + std::to_string(summary.shape_points) + " semi-dense points";
  } else if (settings.semidense.enabled && !settings.localize) {
    shape = ", no semi-dense depth (too few keyframes with parallax)";
  }
  // First tracked frame and losses, if not all frames were tracked.
  std::string tracked;
  if (summary.first_tracked && *summary.first_tracked != run_->log.stamps.first_number())
    tracked += " from frame " + std::to_string(*summary.first_tracked) + " on";
  if (!summary.lost_spans.empty()) tracked += ", lost " + LostInAll(summary.lost_spans);
  const std::string shown = ShellWord(folder),
                    maps = summary.maps > 1 ? " in " + std::to_string(summary.maps) + " maps"
                                            : std::string();
  std::printf(
      "%d of %d frames tracked%s; %d keyframes, %d landmarks%s%s, path %.2f %s%s\n"
      "%s in %s\n",
      summary.tracked, summary.frames, tracked.c_str(), summary.keyframes, summary.landmarks,
      maps.c_str(), shape.c_str(), summary.path_length, summary.metric ? "m" : "map units",
      summary.maps > 1 ? " in the largest" : "",
      run_->log.interrupted ? "Interrupted: results so far" : "Results", shown.c_str());
  // A localization leaves no map to show.
  const std::string view = settings.localize ? "" : ", or: alidade view " + ShellWord(folder);
  std::printf("Open %s%s\n", ShellWord(folder + "/report.html").c_str(), view.c_str());
}

}  // namespace alidade
