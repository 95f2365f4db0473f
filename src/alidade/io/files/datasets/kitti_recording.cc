#include "alidade/io/files/datasets/kitti_recording.h"

#include <algorithm>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/kitti_calibration.h"

namespace alidade {

namespace fs = std::filesystem;

bool IsKittiFolder(const std::string& folder) {
  return IsThere(folder + "/times.txt") &&
         (IsFolder(folder + "/image_0") || IsFolder(folder + "/image_2"));
}

Recording ReadKittiRecording(const std::string& folder) {
  const int left = IsFolder(folder + "/image_0") ? 0 : 2;
  const std::string left_folder = folder + "/image_" + std::to_string(left);
  const std::string right_folder = folder + "/image_" + std::to_string(left + 1);
  const auto images = ImagesIn(left_folder);
  auto list = ReadStampedList(folder + "/times.txt", StampUnit::kSeconds, false, FindUnit::kYes);
  if (images.empty()) ThrowInput(left_folder + " contains no images");
  if (images.size() != list.size()) {
    LogWarning(folder + "/times.txt has " + std::to_string(list.size()) + " times for " +
               std::to_string(images.size()) + " images: frames without one of them are ignored");
    list.resize(std::min(list.size(), images.size()));
  }
  for (size_t i = 0; i < list.size(); ++i) list[i].name = images[i];
  Recording recording;
  recording.kind = "kitti";
  recording.frames = FramesOf(list, left_folder);
  if (IsFolder(right_folder)) {
    for (RecordedFrame& frame : recording.frames) {
      const std::string right = right_folder + "/" + fs::path(frame.image).filename().string();
      if (!IsThere(right)) continue;
      frame.right = right;
      recording.has_right = true;
    }
  }
  const std::string calibration = folder + "/calib.txt";
  if (IsThere(calibration)) {
    recording.calibration = ReadKittiCalibration(calibration, left, SizeOfImages(recording));
  }
  return recording;
}

}  // namespace alidade
