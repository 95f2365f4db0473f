// The folder that `alidade synth` writes a recording to.
#pragma once

#include <optional>
#include <string>

#include "alidade/run/folder/draft_folder.h"
#include "alidade/run/folder/folder_lock.h"

namespace alidade {

// Marker file of folders written by `alidade synth`.
inline constexpr char kSynthMarker[] = "synth.json";

// The folder of a recording, locked. The new recording is written to a temporary folder and
// replaces an earlier one when it is complete; other files remain.
class SynthFolder {
 public:
  // Creates the folder. Throws Error (input) if it contains anything but a recording of ours.
  explicit SynthFolder(const std::string& path);
  const std::string& draft() const { return draft_->path(); }
  void Place();  // throws Error (input)

 private:
  const std::string path_;
  std::optional<FolderLock> lock_;
  std::optional<DraftFolder> draft_;
};

}  // namespace alidade
