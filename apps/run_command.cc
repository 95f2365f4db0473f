// alidade run: a recording or camera in, a trajectory and a map out.
#include <CLI/CLI.hpp>
#include <memory>

#include "alidade/run/loop.h"
#include "alidade/run/run.h"
#include "commands.h"
#include "run_flags.h"
#include "run_progress.h"

namespace alidade {
namespace {

int RunAndTell(const RunOptions& options) {
  CatchInterrupts();
  RunProgress progress(options.quiet);
  return Run(options, {&progress}).status;
}

}  // namespace

void AddRunCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("run", "Track a recording, video or camera and map what it sees");
  auto options = std::make_shared<RunOptions>();
  AddRunOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return RunAndTell(*options); }; });
}

void AddLocalizeCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("localize", "Find the poses of a recording in a saved map");
  auto options = std::make_shared<RunOptions>();
  AddLocalizeOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return RunAndTell(*options); }; });
}

}  // namespace alidade
