// Writes an exported folder completely or not at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/colmap.h"
#include "alidade/run/folder/draft_folder.h"

namespace alidade {

// Files are gathered in a temporary folder next to `path`, which Place() renames to `path`; without
// Place() nothing remains. export.json lists the files and marks the folder as ours.
class ExportFolder {
 public:
  // An existing `path` must be empty or an earlier export without other files. Throws Error (input)
  // otherwise.
  explicit ExportFolder(const std::string& path);
  // `name` may contain a folder. Throws Error (input) if writing fails.
  void Write(const std::string& name, const std::string& bytes);
  void Write(const std::vector<ColmapFile>& files, const std::string& subfolder = "");
  // `format`: the word of --to. Throws Error (input).
  void Place(const std::string& format);

 private:
  std::string path_;
  std::optional<DraftFolder> draft_;  // made by the first Write()
  std::vector<std::string> files_;
};

}  // namespace alidade
