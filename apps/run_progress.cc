#include "run_progress.h"

#include <cmath>
#include <cstdio>
#include <string>

namespace alidade {
namespace {

constexpr double kInterval = 200;  // ms between two updates

const char* NameOf(TrackState state) {
  switch (state) {
    case TrackState::kInitialising:
      return "initialising";
    case TrackState::kTracking:
      return "tracking";
    case TrackState::kLost:
      return "lost";
  }
  return "";
}

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

void RunProgress::Show(int frames, TrackState state, const Slam& slam) {
  if (!terminal_.shows_progress()) return;
  const double now = clock_.Milliseconds();
  if (now - shown_at_ < kInterval) return;
  if (shown_at_ >= 0) {
    const double fps = 1e3 * (frames - shown_frames_) / (now - shown_at_);
    fps_ = fps_ == 0 ? fps : 0.8 * fps_ + 0.2 * fps;
  }
  shown_at_ = now;
  shown_frames_ = frames;
  const MapSnapshot map = slam.Snapshot();
  std::string line = "frame " + std::to_string(frames);
  if (total_ > 0) line += "/" + std::to_string(total_);
  char rate[32];
  std::snprintf(rate, sizeof(rate), "  %.1f/s", fps_);
  if (fps_ > 0) line += rate;
  line += std::string("  ") + NameOf(state) + "  " + std::to_string(map.keyframe_count()) +
          " keyframes  " + std::to_string(map.landmark_count()) + " landmarks";
  if (total_ > 0 && fps_ > 0) line += "  " + Clock((total_ - frames) / fps_) + " left";
  terminal_.SetProgress(line);
}

void RunProgress::ShowFinishing(const Slam& slam) {
  if (!terminal_.shows_progress()) return;
  terminal_.SetProgress("finishing: " + std::to_string(slam.Snapshot().keyframe_count()) +
                        " keyframes are adjusted as a whole");
}

}  // namespace alidade
