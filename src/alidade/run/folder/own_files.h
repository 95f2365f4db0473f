// Which files in a result folder belong to the run.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/run/folder/earlier_result.h"

namespace alidade {

inline constexpr char kStatsFile[] = "stats.json";

// Files that exist only while a run is writing.
inline constexpr char kRunPlace[] = "run";      // the temporary folder is named after it
inline constexpr char kRunLock[] = "run.lock";  // folder_lock.h
inline constexpr char kRunDone[] = "run.done";  // all files, while they are moved to their places

// "trajectory.txt" for the map with the most frames, "trajectory.1.txt" for the next one, and so
// on.
std::string NumberedFile(const std::string& name, size_t number,
                         const std::string& ending = ".txt");

// First line of the lists of depth images. A depth.txt without it belongs to somebody else.
inline constexpr std::string_view kDepthListHeader =
    "# semi-dense depth of keyframes: timestamp filename (5000 per map unit, 0 = none)\n";
// Path of a depth image within the folder; `stamp` as in keyframes.txt.
std::string DepthPictureFile(const std::string& stamp);

// The same for masks (mask_writer.h).
inline constexpr std::string_view kMaskListHeader =
    "# what was left out as moving: timestamp filename (255 = left out)\n";
std::string MaskPictureFile(const std::string& stamp);

// Files and images of the run that wrote `result`. A file with one of these names that is not in
// the list of the run belongs to somebody else. Without a list (older versions) this holds for a
// groundtruth.txt of a recording that was not rendered, and for a camera.yaml that does not say it
// was estimated.
std::vector<std::filesystem::path> OwnFilesIn(const std::filesystem::path& folder,
                                              const EarlierResult& result);

// Throws Error (usage) if `path` is a file of a run's results.
void CheckIsNoResult(const std::string& path);

// Adds files to a result: `write` writes `names` into it, and they are listed in its stats.json, so
// that the next run of the same source removes them. Throws Error: usage if one of them is there
// and is not of the result; input if a run is writing to the folder, or writing fails.
void AddToResult(const std::string& folder, const std::vector<std::string>& names,
                 const std::function<void()>& write);

// Temporary files of killed runs in the folder.
std::vector<std::filesystem::path> LeftoversIn(const std::filesystem::path& folder);

// True if the folder is empty except for temporary files of killed or running runs.
bool HoldsNoResult(const std::filesystem::path& folder, std::error_code& error);

}  // namespace alidade
