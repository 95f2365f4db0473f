// alidade grid: a floor grid for planners from the depth of a result.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/run/surface/surface_files.h"
#include "commands.h"
#include "run/mount_text.h"
#include "surface/surface_flags.h"

namespace alidade {
namespace {

struct GridFlags {
  std::string path;
  std::optional<std::string> mount;
  std::vector<std::string> scale_by;
  std::string out;
  GridSettings how;
};

constexpr char kGridExamples[] =
    "\nExamples:\n"
    "  alidade run rgbd_bag && alidade grid alidade-out/rgbd_bag --out map\n"
    "  ros2 run nav2_map_server map_server --ros-args -p yaml_filename:=map.yaml\n"
    "  alidade grid alidade-out/tour --cell 0.1 --height 0.4        a low robot, coarser cells\n"
    "  alidade grid alidade-out/tour --mount \"0.2 0 0.5 0 0.3 0\"    in the frame `map` of "
    "`alidade ros2`\n"
    "  alidade grid alidade-out/walk --scale-by 2.0 7.5 1.20        one camera, with --semidense\n"
    "\nWrites map.pgm and map.yaml as map_server of Nav2 and ROS 1 reads them. Guide: "
    "docs/guides/grid-and-mesh.md.";

int MakeGrid(const GridFlags& flags) {
  GridSettings how = flags.how;
  if (flags.mount) how.T_base_camera = MountOf(*flags.mount);
  if (!flags.scale_by.empty()) how.views.scale_by = KnownDistanceOf(flags.scale_by);
  return RunSurfaceCommand([&](const ExportProgress& progress) {
    return WriteGridFiles(flags.path, how, flags.out, progress);
  });
}

}  // namespace

void AddGridCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("grid", "Make a grid of free and occupied floor for robots' planners");
  const auto flags = std::make_shared<GridFlags>();
  AddSurfaceOptions(*command, flags->path, flags->out, flags->how.views,
                    "Files to write: OUT.pgm and OUT.yaml; default: map in the result folder, "
                    "shown in its report.html");
  OccupancySettings& grid = flags->how.occupancy;
  command->add_option("--cell", grid.cell, "Edge length of a cell, meters")
      ->type_name("METERS")
      ->capture_default_str();
  command
      ->add_option("--height", grid.height,
                   "Height of the robot, meters: what hangs higher is no obstacle")
      ->type_name("METERS")
      ->capture_default_str();
  command
      ->add_option("--clearance", grid.clearance,
                   "Meters above the floor: what is lower is driven over")
      ->type_name("METERS")
      ->capture_default_str();
  command
      ->add_option("--range", grid.range,
                   "Farther depth is left out, meters; default: where its standard deviation is "
                   "one cell")
      ->type_name("METERS");
  command
      ->add_option("--camera-height", flags->how.camera_height,
                   "Height of the camera above the floor at the first frame, meters; default: the "
                   "floor is found in the depth")
      ->type_name("METERS");
  command
      ->add_option("--mount", flags->mount, std::string(kMountHelp) + "at the base, looking ahead")
      ->type_name("NUMBERS");
  command
      ->add_option("--scale-by", flags->scale_by,
                   "Maps of one camera: lengths become meters, as in `alidade export`")
      ->expected(3)
      ->type_name("A B METERS");
  command->footer(kGridExamples);
  command->callback([flags, &action] { action = [flags] { return MakeGrid(*flags); }; });
}

}  // namespace alidade
