#include <memory>

#include "bench/benches.h"
#include "bench/options.h"
#include "bench/wild/wild.h"

namespace alidade::bench {

void AddWildBench(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "wild", "Rendered recordings like the videos users have: starts, coverage, false poses");
  const auto options = std::make_shared<WildOptions>();
  command->add_option("--cases", options->cases, "Which, with commas between them; default: all");
  AddSeeds(*command, options->seeds, "Runs of each case");
  AddFrames(*command, options->frames, "Frames of each, at most; default: all it has");
  command->add_option("--profile", options->profile, "Of all cases; default: each its own")
      ->type_name("desktop|phone");
  AddSettings(*command, options->settings);
  command->add_flag("--check", options->check, "Exit with 1 when there is a false pose or map");
  AddOut(*command, options->out);
  command->callback([options, &action] { action = [options] { return BenchWild(*options); }; });
}

}  // namespace alidade::bench
