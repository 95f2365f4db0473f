#include "alidade/io/files/datasets/folder_recording.h"

#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/trajectory.h"

namespace alidade {

bool IsImageFolder(const std::string& folder) { return !ImagesIn(folder).empty(); }

Recording ReadFolderRecording(const std::string& folder) {
  Recording recording;
  recording.kind = "images";
  for (const std::string& image : ImagesIn(folder)) {
    RecordedFrame frame;
    frame.image = folder + "/" + image;
    recording.frames.push_back(std::move(frame));
  }
  return recording;
}

void SetTimes(Recording& recording, double fps) {
  for (size_t i = 0; i < recording.frames.size(); ++i) {
    RecordedFrame& frame = recording.frames[i];
    frame.time = static_cast<double>(i) / fps;
    frame.stamp = FormatTime(frame.time);
  }
}

}  // namespace alidade
