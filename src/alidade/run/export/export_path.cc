#include "alidade/run/export/export_path.h"

#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/run/export/mcap_export.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/version.h"

namespace alidade {
namespace {

std::string InWords(const McapCounts& counts, const char* frames) {
  char megabytes[32];
  PrintTo(megabytes, sizeof megabytes, "%.1f MB", 1e-6 * static_cast<double>(counts.bytes));
  const std::string shape =
      counts.shape > 0 ? std::to_string(counts.shape) + " semi-dense points, " : "";
  return std::to_string(counts.frames) + " " + frames + ", " + std::to_string(counts.landmarks) +
         " landmarks, " + shape + megabytes;
}

std::string ExportToMcap(const std::string& path, const ExportSettings& settings,
                         const std::string& out) {
  const std::string stream = StreamIn(path), program = "alidade " ALIDADE_VERSION;
  std::error_code error;
  if (std::filesystem::equivalent(stream.empty() ? path : stream, out, error))
    ThrowUsage("OUT is the source itself; choose another file");
  CheckIsNoResult(out);
  const bool map = stream.empty() && !std::filesystem::is_directory(path, error);
  if (!map && (settings.part != 0 || settings.min_observations != 1)) {
    ThrowUsage("--part and --min-observations apply to a map: give the file map.alidade");
  }
  if (map) {
    const SavedMap saved = ReadSavedMap(path);
    return InWords(ExportMapToMcap(saved, PartFor(saved, settings), out, program), "keyframes");
  }
  return InWords(
      stream.empty() ? ExportResults(path, out, program) : ExportStream(stream, out, program),
      "frames");
}

}  // namespace

std::string ExportPath(const std::string& path, const ExportSettings& settings,
                       const std::string& out) {
  settings.Check();
  if (settings.to == "mcap") return ExportToMcap(path, settings, out);
  std::error_code error;
  if (std::filesystem::equivalent(SavedMapPath(path), out, error)) {
    ThrowUsage("OUT is the map itself; choose another file");
  }
  CheckIsNoResult(out);
  return ExportMap(ReadSavedMap(path), settings, out);
}

}  // namespace alidade
