// Replaces the files of an earlier run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace alidade {

// Removes from `draft` what would overwrite a file of `folder` that belongs neither to an earlier
// run nor to `inputs`, with a warning.
void LeaveFilesOfOthers(const std::filesystem::path& draft, const std::filesystem::path& folder,
                        const std::vector<std::string>& inputs);

// Moves the files of `draft`, which must be on the same file system, into `folder`, and removes
// those of the earlier run except `inputs`. Meanwhile the folder has no stats.json; if the process
// is killed, all files of the new run remain and FinishPlacing() completes the move. Throws Error
// (input).
void PlaceFiles(const std::filesystem::path& draft, const std::filesystem::path& folder,
                const std::vector<std::string>& inputs);
void FinishPlacing(const std::filesystem::path& folder, const std::vector<std::string>& inputs);

}  // namespace alidade
