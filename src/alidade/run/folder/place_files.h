// A run's files take the place of an earlier run's.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace alidade {

// Takes out of `draft` what would be written over a file of `folder` that is neither an earlier
// run's nor one of `inputs`, and says so.
void LeaveFilesOfOthers(const std::filesystem::path& draft, const std::filesystem::path& folder,
                        const std::vector<std::string>& inputs);

// Moves the files of `draft`, which is on the same file system, into `folder`, and removes those of
// the earlier run there, but for `inputs`. While that goes on the folder has no stats.json: who is
// killed then leaves all files of the new run, and FinishPlacing() goes on. Throws Error (input).
void PlaceFiles(const std::filesystem::path& draft, const std::filesystem::path& folder,
                const std::vector<std::string>& inputs);
void FinishPlacing(const std::filesystem::path& folder, const std::vector<std::string>& inputs);

}  // namespace alidade
