#include "alidade/run/export/export_folder.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/folder/draft_folder.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = "export.json";
constexpr std::array<const char*, 7> kOurFiles = {"cameras.txt", "images.txt", "points3D.txt",
                                                  "cameras.bin", "images.bin", "points3D.bin",
                                                  kMarker};

bool HoldsOnlyOurs(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    bool ours = false;
    for (const char* known : kOurFiles) ours = ours || name == known;
    if (!ours || !entry.is_regular_file(error)) return false;
  }
  return !error;
}

bool HoldsOurMarker(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / kMarker, error)) return false;
  const auto marker = nlohmann::json::parse(ReadFile((folder / kMarker).string()), nullptr, false);
  return marker.is_object() && marker.contains("version") && marker.contains("colmap");
}

void CheckFree(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return;
  if (!fs::is_directory(path, error)) ThrowInput(path.string() + " is a file, not a folder");
  const bool empty = fs::is_empty(path, error);
  if (error) ThrowInput(path.string() + ": " + error.message());
  if (!empty && !(HoldsOurMarker(path) && HoldsOnlyOurs(path))) {
    ThrowInput(path.string() +
               ": the folder contains other files than an earlier export; choose another");
  }
}

}  // namespace

void WriteExportFolder(const std::string& folder, const std::vector<ColmapFile>& files) {
  fs::path path = fs::path(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // with a trailing slash
  CheckFree(path);
  for (const std::string& left : StaleTemporaries(path.string())) {
    std::error_code ignored;
    if (HoldsOnlyOurs(left)) fs::remove_all(left, ignored);
  }
  const DraftFolder draft(path.string());
  for (const ColmapFile& file : files) {
    AtomicWriteFile(draft.path() + "/" + file.name, file.bytes);
  }
  const nlohmann::ordered_json marker = {{"version", 1}, {"colmap", files.size()}};
  AtomicWriteFile(draft.path() + "/" + kMarker, marker.dump(2) + "\n");
  std::error_code error;
  for (const char* name : kOurFiles) fs::remove(path / name, error);
  fs::rename(draft.path(), path, error);
  if (error) ThrowInput(path.string() + ": cannot be written: " + error.message());
}

}  // namespace alidade
