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
#include "alidade/run/ros2/robot_frames.h"
#include "alidade/surface/floor.h"
#include "alidade/view/upright.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr double kStereoVoxel = 0.04;  // meters: its depth has three times the error of a sensor's
// Of the floor against gravity, beside the uncertainty of gravity: that of a room's floor, 2°.
constexpr double kFloorTilt = 0.035;
// Of the floor against the up direction of the cameras, which may look down by as much, radians.
constexpr double kCameraTilt = 0.6;

std::string NumbersIn(const char* format, double a, double b = 0) {
  char text[160];
  PrintTo(text, sizeof text, format, a, b);
  return text;
}

bool EndsIn(const std::string& path, const std::string& ending) {
  return path.size() > ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

// `out` without any of the endings; the default is `name` in the result folder.
std::string StemOf(const std::string& path, std::string out, const char* name,
                   const std::vector<std::string>& endings) {
  if (out.empty()) {
    const std::string folder = ResultFolderOf(path);
    if (folder.empty())
      ThrowUsage(path + " is not in a result folder: name the files to write with --out");
    return folder + "/" + name;
  }
  for (const std::string& ending : endings) {
    if (EndsIn(out, ending)) return out.substr(0, out.size() - ending.size());
  }
  if (IsFolder(out)) return (fs::path(out) / name).string();
  return out;
}

// Warns of nothing, throws for files of the run.
void CheckPlaces(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    CheckIsNoResult(file);
    const std::string folder = fs::path(file).parent_path().string();
    if (!folder.empty() && !IsFolder(folder)) ThrowInput(folder + ": there is no such folder");
  }
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

Eigen::Matrix3d UprightOf(const ViewWorld& world) {
  return UprightAxes({world.path},
                     world.up ? std::optional<Eigen::Vector3d>(-*world.up) : std::nullopt);
}

// Rows: x, y and z of glTF, where y is up and z comes towards the viewer.
Eigen::Matrix3d GltfAxes(const ViewWorld& world) {
  const Eigen::Matrix3d axes = UprightOf(world);  // right, forward, up
  Eigen::Matrix3d gltf;
  gltf << axes.row(0), axes.row(2), -axes.row(1);
  return gltf;
}

Floor FloorFor(const std::string& path, const std::vector<DenseView>& views, const ViewWorld& world,
               const GridSettings& settings) {
  const Eigen::Vector3d up = UprightOf(world).row(2);
  if (settings.camera_height) {
    Floor floor;
    floor.up = up;
    floor.height = up.dot(world.path.front().t) - *settings.camera_height;
    return floor;
  }
  FloorSettings search;
  search.most_tilt = world.up ? kFloorTilt + 3 * world.up_sigma : kCameraTilt;
  const auto floor = FindFloor(views, up, search);
  if (!floor)
    ThrowInput(path +
               ": no floor was seen: the lowest large level plane below the camera. Give the "
               "height of the camera above the floor with --camera-height");
  return *floor;
}

// A world with z up (aligned by a survey, exported) keeps its axes; else those of the robot's base
// at the first frame are levelled.
Se3 FrameOf(const Floor& floor, const std::optional<Se3>& T_base_camera) {
  constexpr double kLevel = 0.985;  // cosine of 10°
  if (!T_base_camera && floor.up.z() > kLevel)
    return floor.FrameFor(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX());
  const Se3 T_world_base = T_base_camera.value_or(CameraAtBase()).Inverse();
  return floor.FrameFor(T_world_base.t, T_world_base.R.col(0));
}

std::string AreaInWords(const OccupancyPicture& picture, const ViewWorld& world) {
  const auto count = [&](int8_t state) {
    return static_cast<double>(std::count(picture.cells.begin(), picture.cells.end(), state)) *
           picture.cell * picture.cell;
  };
  return NumbersIn("free %.1f, occupied %.1f", count(0), count(100)) +
         (world.meters ? " m²" : " square map units");
}

std::vector<std::string> GridNotes(const std::string& path, const Floor& floor,
                                   const ViewSummary& summary, const GridSettings& settings) {
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
                           const ExportProgress& progress) {
  const SavedMap saved = ReadSavedMap(path);
  if (saved.sensor == NameOf(Sensor::kMono))
    ThrowUsage(path + " is of one camera: a mesh needs the depth of a sensor or of a stereo pair");
  const std::string stem = StemOf(path, settings.out, "mesh", {".ply", ".glb"});
  const bool ply = !EndsIn(settings.out, ".glb"), glb = !EndsIn(settings.out, ".ply");
  std::vector<std::string> files;
  if (ply) files.push_back(stem + ".ply");
  if (glb) files.push_back(stem + ".glb");
  CheckPlaces(files);
  MeshSettings how = settings;
  if (!how.voxel_given && saved.sensor == NameOf(Sensor::kStereo)) how.tsdf.voxel = kStereoVoxel;
  how.views.color = true;
  Tsdf tsdf(how.tsdf);
  const ViewSummary summary = ForEachDenseView(path, saved, how.views, progress,
                                               [&](const DenseView& view) { tsdf.Add(view); });
  const size_t megabytes = tsdf.bytes() >> 20;
  const Mesh mesh = tsdf.MakeMesh();
  if (mesh.triangles.empty())
    ThrowInput(path + ": its depth makes no surface; try larger voxels (--voxel)");
  if (ply) AtomicWriteFile(stem + ".ply", EncodeMeshPly(mesh));
  if (glb) AtomicWriteFile(stem + ".glb", EncodeGlb(mesh, GltfAxes(summary.world)));
  return (ply && glb ? stem + ".ply and .glb" : files.front()) + ": " +
         std::to_string(mesh.triangles.size()) + " triangles from " +
         DepthInWords(summary, how.views) + ", voxels of " +
         NumbersIn("%.3g m, %.0f MB", how.tsdf.voxel, static_cast<double>(megabytes));
}

std::string WriteGridFiles(const std::string& path, const GridSettings& settings,
                           const ExportProgress& progress) {
  const SavedMap saved = ReadSavedMap(path);
  const std::string stem = StemOf(path, settings.out, "map", {".pgm", ".yaml"});
  CheckPlaces({stem + ".pgm", stem + ".yaml"});
  std::vector<DenseView> views;
  const ViewSummary summary = ForEachDenseView(
      path, saved, settings.views, progress, [&](const DenseView& view) { views.push_back(view); });
  const Floor floor = FloorFor(path, views, summary.world, settings);
  OccupancyMap map(settings.occupancy, FrameOf(floor, settings.T_base_camera));
  for (const DenseView& view : views) map.Add(view);
  const OccupancyPicture picture = map.Picture();
  if (picture.cells.empty())
    ThrowInput(path + ": no cell of the floor is known; try larger ones (--cell)");
  AtomicWriteFile(stem + ".pgm", EncodeGridPgm(picture));
  AtomicWriteFile(stem + ".yaml",
                  EncodeGridYaml(picture, fs::path(stem + ".pgm").filename().string(),
                                 GridNotes(path, floor, summary, settings)));
  return stem + ".yaml and .pgm: " + std::to_string(picture.width) + " x " +
         std::to_string(picture.height) + " cells of " + NumbersIn("%.3g", picture.cell) +
         UnitOf(summary.world) + ", " + AreaInWords(picture, summary.world) + ", from " +
         DepthInWords(summary, settings.views);
}

}  // namespace alidade
