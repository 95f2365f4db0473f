#include <memory>

#include "bench/benches.h"
#include "bench/options.h"
#include "bench/surface/surface.h"

namespace alidade::bench {

void AddSurfaceBench(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("surface", "Meshes and floor grids beside the true rendered scene");
  const auto options = std::make_shared<SurfaceOptions>();
  AddMany(*command, "--scene", options->scenes,
          "Rendered scenes; default: room, desk, table, loop");
  AddSeeds(*command, options->seeds, "Scenes of each kind");
  AddFrames(*command, options->frames, "Frames of each");
  AddOut(*command, options->out);
  command->callback([options, &action] { action = [options] { return BenchSurface(*options); }; });
}

}  // namespace alidade::bench
