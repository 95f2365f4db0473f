// Names of exported images.
#pragma once

#include <set>
#include <string>

#include "alidade/run/export/own_recording.h"

namespace alidade {

class ImageNames {
 public:
  explicit ImageNames(const OwnRecording& recording)
      : video_(recording.source->Info().kind == "video"), files_(recording.image_files) {}

  // The name of the recording's own file, with _ for whitespace, control characters, quotes and
  // backslashes, which COLMAP's text files or a shell would take apart, and for bytes that are not
  // UTF-8; ending in .png if the file is neither PNG nor JPEG. Without a file of its own: the
  // frame's number, frame_000123.jpg of a video, else .png. Unique: -2, -3, … is appended.
  std::string NameOf(const SourceFrame& frame);

  static bool IsJpeg(const std::string& name);  // by its ending

 private:
  bool video_;
  std::vector<std::string> files_;
  std::set<std::string> taken_;
};

}  // namespace alidade
