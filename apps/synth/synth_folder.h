// The folder that `alidade synth` writes a recording to.
#pragma once

#include <optional>
#include <string>

#include "alidade/run/folder/draft_folder.h"
#include "alidade/run/folder/folder_lock.h"

namespace alidade {

// The file that says a folder is ours.
inline constexpr char kSynthMarker[] = "synth.json";

// The folder of a recording, locked. The new one is gathered beside an earlier one of ours and
// takes its place when it is whole; files that are not ours stay.
class SynthFolder {
 public:
  // Makes the folder. Throws Error (input) when it holds anything else than a recording of ours.
  explicit SynthFolder(const std::string& path);
  const std::string& draft() const { return draft_->path(); }
  void Place();  // throws Error (input)

 private:
  const std::string path_;
  std::optional<FolderLock> lock_;
  std::optional<DraftFolder> draft_;
};

}  // namespace alidade
