// Which files in a folder of results are a run's own.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/run/folder/earlier_result.h"

namespace alidade {

inline constexpr char kStatsFile[] = "stats.json";

// What is in the folder only while a run is at work there.
inline constexpr char kRunPlace[] = "run";      // its files are gathered in a temporary beside that
inline constexpr char kRunLock[] = "run.lock";  // folder_lock.h
inline constexpr char kRunDone[] = "run.done";  // all files, on their way to their place

// Of the map with the most frames "trajectory.txt", of the next "trajectory.1.txt", and so on.
std::string NumberedFile(const std::string& name, size_t number,
                         const std::string& ending = ".txt");

// First line of the lists of depth pictures: a depth.txt without it is not ours.
inline constexpr std::string_view kDepthListHeader =
    "# semi-dense depth of keyframes: timestamp filename (5000 per map unit, 0 = none)\n";
// Where a depth picture is, within the folder; `stamp` as in keyframes.txt.
std::string DepthPictureFile(const std::string& stamp);

// The same of masks (mask_writer.h).
inline constexpr std::string_view kMaskListHeader =
    "# what was left out as moving: timestamp filename (255 = left out)\n";
std::string MaskPictureFile(const std::string& stamp);

// Files and pictures of the run that left `result` in the folder. What has one of our names and is
// not in its list is someone else's; so is, where an older version kept no list, a groundtruth.txt
// of a recording that was not rendered, and a camera.yaml that does not say it was found by us.
std::vector<std::filesystem::path> OwnFilesIn(const std::filesystem::path& folder,
                                              const EarlierResult& result);

// Throws Error (usage) when a run wrote that file among its results: nothing else writes there.
void CheckIsNoResult(const std::string& path);

// What runs that were killed left there, and nobody uses any more.
std::vector<std::filesystem::path> LeftoversIn(const std::filesystem::path& folder);

// There is nothing in it, or only what runs that were killed, or are going on, have there.
bool HoldsNoResult(const std::filesystem::path& folder, std::error_code& error);

}  // namespace alidade
