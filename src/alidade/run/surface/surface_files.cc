#include "alidade/run/surface/surface_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/files/file.h"
#include "alidade/run/export/own_recording.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/surface/surface_report.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::string NumbersIn(const char* format, double a, double b = 0) {
  char text[160];
  PrintTo(text, sizeof text, format, a, b);
  return text;
}

bool EndsIn(const std::string& path, const std::string& ending) {
  return path.size() > ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

// Where the files go: beside each other, named `stem` and an ending.
struct Place {
  std::string stem;
  std::string folder;  // of the result, if they become files of it; empty: elsewhere
};

// `name`: of the files in the result folder.
Place PlaceFor(const std::string& path, const std::string& out, const std::string& name,
               const std::vector<std::string>& endings) {
  const std::string folder = ResultFolderOf(path);
  if (out.empty()) {
    if (folder.empty())
      ThrowUsage(path + " is not in a result folder: name the files to write with --out");
    return {(fs::path(folder) / name).string(), folder};
  }
  for (const std::string& ending : endings) {
    if (EndsIn(out, ending)) return {out.substr(0, out.size() - ending.size()), ""};
  }
  return {IsFolder(out) ? (fs::path(out) / name).string() : out, ""};
}

struct NamedBytes {
  std::string ending, bytes;
};

// Before the recording is read, and again before writing.
void CheckSurfacePlace(const Place& place, const std::vector<std::string>& endings) {
  if (!place.folder.empty()) return;  // AddToResult() does
  for (const std::string& ending : endings) CheckIsNoResult(place.stem + ending);
  const std::string folder = fs::path(place.stem).parent_path().string();
  if (!folder.empty() && !IsFolder(folder)) ThrowInput(folder + ": there is no such folder");
}

// `show`: puts what was written into the report of the result, if it becomes a part of it.
void WriteAll(const Place& place, const std::vector<NamedBytes>& files,
              const std::function<void()>& show) {
  std::vector<std::string> names;
  for (const NamedBytes& file : files)
    names.push_back(fs::path(place.stem + file.ending).filename().string());
  const auto write = [&] {
    for (const NamedBytes& file : files) AtomicWriteFile(place.stem + file.ending, file.bytes);
    if (!place.folder.empty()) show();
  };
  if (place.folder.empty()) return write();
  AddToResult(place.folder, names, write);
}

std::string UnitOf(const ViewWorld& world) { return world.meters ? " m" : " map units"; }

std::string DepthInWords(const ViewSummary& summary, const DenseViewSettings& settings) {
  const char* kind = summary.kind == DepthKind::kSensor   ? "sensor depth"
                     : summary.kind == DepthKind::kStereo ? "stereo depth"
                                                          : "semi-dense depth";
  std::string words = std::string(kind) + " of " + std::to_string(summary.views) +
                      (settings.every > 0 ? " frames" : " keyframes");
  if (summary.without > 0) words += " (" + std::to_string(summary.without) + " have none)";
  return words;
}

std::string AreaInWords(const OccupancyPicture& picture, const ViewWorld& world) {
  const auto count = [&](int8_t state) {
    return static_cast<double>(std::count(picture.cells.begin(), picture.cells.end(), state)) *
           picture.cell * picture.cell;
  };
  return NumbersIn("free %.1f, occupied %.1f", count(0), count(100)) +
         (world.meters ? " m²" : " square map units");
}

std::vector<std::string> GridNotes(const std::string& path, const GridResult& grid,
                                   const GridSettings& settings) {
  const Floor& floor = grid.floor;
  const ViewSummary& summary = grid.views;
  std::vector<std::string> notes = {
      "Floor grid of " + fs::path(path).lexically_normal().filename().string() +
          " by alidade: " + DepthInWords(summary, settings.views) + ".",
      NumbersIn("Occupied: things %.3g to %.3g", settings.occupancy.clearance,
                settings.occupancy.height) +
          UnitOf(summary.world) + " above the floor."};
  notes.push_back(
      settings.camera_height
          ? NumbersIn("The floor is taken to be %.3g m below the first camera.",
                      *settings.camera_height)
          : NumbersIn("The floor is a plane through %.0f %% of the seen surface, within %.1f",
                      100 * floor.share, (summary.world.meters ? 1000 : 1) * floor.sigma) +
                (summary.world.meters ? " mm (rms)." : " map units (rms)."));
  if (!summary.world.meters)
    notes.push_back("UNITS ARE NOT METERS: one camera does not know its scale (--scale-by).");
  return notes;
}

}  // namespace

std::string WriteMeshFiles(const std::string& path, const MeshSettings& settings,
                           const std::string& out, const ExportProgress& progress) {
  const Place place = PlaceFor(path, out, "mesh", {".ply", ".glb"});
  std::vector<std::string> endings;
  if (!EndsIn(out, ".glb")) endings.push_back(".ply");
  if (!EndsIn(out, ".ply")) endings.push_back(".glb");
  CheckSurfacePlace(place, endings);
  const MeshResult made = MakeMesh(path, settings, progress);
  std::vector<NamedBytes> files;
  for (const std::string& ending : endings)
    files.push_back(
        {ending, ending == ".ply" ? EncodeMeshPly(made.mesh) : EncodeGlb(made.mesh, made.R_up)});
  const std::string words =
      std::to_string(made.mesh.triangles.size()) + " triangles from " +
      DepthInWords(made.views, settings.views) +
      NumbersIn(", voxels of %.3g m (%.0f MB)", made.voxel, static_cast<double>(made.bytes) / 1e6);
  WriteAll(place, files, [&] { ShowInReport(place.folder, made, words); });
  return place.stem + endings.front() + (endings.size() > 1 ? " and .glb" : "") + ": " + words;
}

std::string WriteGridFiles(const std::string& path, const GridSettings& settings,
                           const std::string& out, const ExportProgress& progress) {
  const Place place = PlaceFor(path, out, "map", {".pgm", ".yaml"});
  CheckSurfacePlace(place, {".pgm", ".yaml"});
  const GridResult made = MakeGrid(path, settings, progress);
  const std::string image = fs::path(place.stem + ".pgm").filename().string();
  const ViewWorld& world = made.views.world;
  std::string words =
      std::to_string(made.picture.width) + " x " + std::to_string(made.picture.height) +
      " cells of " + NumbersIn("%.3g", made.picture.cell) + UnitOf(world) + ", " +
      AreaInWords(made.picture, world) + ", from " + DepthInWords(made.views, settings.views);
  if (!settings.camera_height)
    words += NumbersIn("; the floor is %.0f %% of the seen surface", 100 * made.floor.share);
  if (!world.meters) words += "; units are the map's, not meters (--scale-by)";
  WriteAll(place,
           {{".pgm", EncodeGridPgm(made.picture)},
            {".yaml", EncodeGridYaml(made.picture, image, GridNotes(path, made, settings))}},
           [&] { ShowInReport(place.folder, made, words); });
  return place.stem + ".yaml and .pgm: " + words;
}

}  // namespace alidade
