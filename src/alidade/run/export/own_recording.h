// Opens the recording of a result again, and finds out whether it is the one the map was made of.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/features/extractor.h"
#include "alidade/io/frame_source.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

// The recording as its run read it (`reading` of stats.json).
struct OwnRecording {
  std::string path;    // as for OpenAnySource()
  std::string folder;  // of the result; empty: the map lies alone
  std::unique_ptr<FrameSource> source;
  std::vector<std::string>
      image_files;  // by SourceFrame::number; empty: not of files (videos, bags)
  Sim3 T_now_then;  // by which the map was moved since it was read, unlike the folder's files
};

// The folder of the run that wrote the map `path`, or of the result folder `path`; empty: none.
std::string ResultFolderOf(const std::string& path);

// `path`: of a map or a result folder. `source`, `camera`: instead of those of the run. Throws
// Error (input) if the recording is not known, gone or has another image size than the map.
OwnRecording OpenOwnRecording(const std::string& path, const SavedMap& saved,
                              const std::optional<std::string>& source,
                              const std::optional<std::string>& camera);

// Compares images with the features of keyframes.
class ImageCheck {
 public:
  explicit ImageCheck(const SavedMap& saved);
  // Whether extracting features from the image finds those of the keyframe again.
  bool Shows(const cv::Mat& gray, const KeyFrame& keyframe);

 private:
  Camera camera_;
  Extractor extractor_;
};

}  // namespace alidade
