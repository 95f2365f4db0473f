#include "alidade/io/files/datasets/folder_recording.h"

#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/trajectory.h"

namespace alidade {

bool IsImageFolder(const std::string& folder) { return !ImagesIn(folder).empty(); }

Recording ReadFolderRecording(const std::string& folder, std::optional<double> fps) {
  Recording recording;
  recording.kind = "images";
  const std::string camera = folder + "/camera.yaml";
  if (IsThere(camera)) recording.calibration = ReadCameraFile(camera);
  recording.fps_assumed = !fps && !recording.calibration;
  const double rate = fps ? *fps : recording.calibration ? recording.calibration->fps : 30;
  const auto images = ImagesIn(folder);
  for (size_t i = 0; i < images.size(); ++i) {
    RecordedFrame frame;
    frame.time = static_cast<double>(i) / rate;
    frame.stamp = FormatTime(frame.time);
    frame.image = folder + "/" + images[i];
    recording.frames.push_back(std::move(frame));
  }
  return recording;
}

}  // namespace alidade
