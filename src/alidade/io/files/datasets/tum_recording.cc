#include "alidade/io/files/datasets/tum_recording.h"

#include <algorithm>

#include "alidade/base/log.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

// Seconds, more than half a frame interval at 30 Hz; the default of TUM's associate.py.
constexpr double kMaxDepthDelay = 0.02;

void AddDepth(Recording& recording, const std::string& folder) {
  const auto list =
      ReadStampedList(folder + "/depth.txt", StampUnit::kSeconds, true, FindUnit::kYes);
  const int found =
      AttachByTime(recording.frames, &RecordedFrame::depth, list, folder, kMaxDepthDelay);
  const auto good = std::count_if(recording.frames.begin(), recording.frames.end(),
                                  [](const RecordedFrame& frame) { return frame.problem.empty(); });
  if (found < good) {
    LogWarning(std::to_string(good - found) + " of " + std::to_string(good) +
               " frames have no depth image within 0.02 s");
  }
  recording.has_depth = found > 0;
}

}  // namespace

bool IsTumFolder(const std::string& folder) { return IsThere(folder + "/rgb.txt"); }

Recording ReadTumRecording(const std::string& folder) {
  Recording recording;
  recording.kind = "tum";
  recording.frames = FramesOf(
      ReadStampedList(folder + "/rgb.txt", StampUnit::kSeconds, true, FindUnit::kYes), folder);
  recording.default_depth_factor = 5000;
  if (IsThere(folder + "/depth.txt")) AddDepth(recording, folder);
  return recording;
}

}  // namespace alidade
