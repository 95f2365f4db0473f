#include "alidade/io/files/tum_recording.h"

#include <filesystem>

#include "alidade/base/log.h"
#include "alidade/io/association.h"
#include "alidade/io/files/camera_file.h"

namespace alidade {
namespace {

constexpr double kMaxDepthDelay =
    0.02;  // seconds: over half a frame at 30 Hz, as TUM's tools have it

void AddDepth(Recording& recording, const std::string& folder) {
  std::vector<double> depth_times, image_times;
  std::vector<std::string> depth_paths;
  for (const StampedName& item :
       ReadStampedList(folder + "/depth.txt", StampUnit::kSeconds, true)) {
    if (!item.problem.empty()) {
      LogWarning(item.problem + "; this depth image is left out");
      continue;
    }
    depth_times.push_back(item.time);
    depth_paths.push_back(folder + "/" + item.name);
  }
  std::vector<RecordedFrame*> images;
  for (RecordedFrame& frame : recording.frames) {
    if (!frame.problem.empty()) continue;
    images.push_back(&frame);
    image_times.push_back(frame.time);
  }
  const auto pairs = AssociateByTime(image_times, depth_times, kMaxDepthDelay);
  for (const auto& [image, depth] : pairs) {
    images[static_cast<size_t>(image)]->depth = depth_paths[static_cast<size_t>(depth)];
  }
  if (pairs.size() < images.size()) {
    LogWarning(std::to_string(images.size() - pairs.size()) + " of " +
               std::to_string(images.size()) + " frames have no depth image within 0.02 s");
  }
  recording.has_depth = !pairs.empty();
}

}  // namespace

bool IsTumFolder(const std::string& folder) {
  return std::filesystem::is_regular_file(folder + "/rgb.txt");
}

Recording ReadTumRecording(const std::string& folder) {
  Recording recording;
  recording.kind = "tum";
  recording.frames =
      FramesOf(ReadStampedList(folder + "/rgb.txt", StampUnit::kSeconds, true), folder);
  recording.default_depth_factor = 5000;
  if (std::filesystem::is_regular_file(folder + "/depth.txt")) AddDepth(recording, folder);
  const std::string camera = folder + "/camera.yaml";
  if (std::filesystem::is_regular_file(camera)) recording.calibration = ReadCameraFile(camera);
  return recording;
}

}  // namespace alidade
