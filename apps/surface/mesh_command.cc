// alidade mesh: a mesh from the depth of a result.
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "alidade/run/surface/surface_files.h"
#include "commands.h"
#include "surface/surface_flags.h"

namespace alidade {
namespace {

struct MeshFlags {
  std::string path;
  std::optional<double> voxel;
  std::string out;
  MeshSettings how;
};

constexpr char kMeshExamples[] =
    "\nExamples:\n"
    "  alidade run kitchen && alidade mesh alidade-out/kitchen    mesh.ply and mesh.glb\n"
    "  alidade mesh alidade-out/kitchen --voxel 0.01 --out fine.glb\n"
    "  alidade mesh alidade-out/kitchen --every 5                 more frames than keyframes\n"
    "\nNeeds a depth camera or a stereo pair, and the recording, which is read again. PLY is in "
    "the\nworld of trajectory.txt; GLB (Blender, browsers, three.js) stands upright. Guide:\n"
    "docs/guides/grid-and-mesh.md.";

int MakeMesh(const MeshFlags& flags) {
  MeshSettings how = flags.how;
  how.voxel_given = flags.voxel.has_value();
  if (flags.voxel) how.tsdf.voxel = *flags.voxel;
  return RunSurfaceCommand([&](const ExportProgress& progress) {
    return WriteMeshFiles(flags.path, how, flags.out, progress);
  });
}

}  // namespace

void AddMeshCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("mesh", "Make a colored mesh from the depth of a run");
  const auto flags = std::make_shared<MeshFlags>();
  AddSurfaceOptions(*command, flags->path, flags->out, flags->how.views,
                    "Files to write: OUT.ply and OUT.glb, or one of them if OUT has its ending; "
                    "default: mesh in the result folder, shown in its report.html");
  command
      ->add_option("--voxel", flags->voxel,
                   "Edge length of a voxel, meters. Default: 0.02, with stereo 0.04")
      ->type_name("METERS");
  command
      ->add_option("--range", flags->how.tsdf.range,
                   "Farther depth is left out, meters; default: where its standard deviation is "
                   "two voxels")
      ->type_name("METERS");
  command->footer(kMeshExamples);
  command->callback([flags, &action] { action = [flags] { return MakeMesh(*flags); }; });
}

}  // namespace alidade
