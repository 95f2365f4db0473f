// alidade run: a recording or camera in, a trajectory and a map out.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include "alidade/run/loop.h"
#include "alidade/run/run.h"
#include "alidade/run/stream_feed.h"
#include "alidade/version.h"
#include "commands.h"
#include "run_flags.h"
#include "run_progress.h"

namespace alidade {
namespace {

int RunAndTell(const RunOptions& options) {
  CatchInterrupts();
  RunProgress progress(options.quiet);
  std::vector<RunWatcher*> watchers = {&progress};
  std::optional<StreamFeed> feed;
  if (options.record || options.view) {
    feed.emplace("alidade " ALIDADE_VERSION, options.record);
    watchers.push_back(&*feed);
  }
  const int status = Run(options, watchers).status;
  if (options.record && !options.quiet && feed->frames() > 0)
    std::printf("The stream takes %.1f MB\n", 1e-6 * static_cast<double>(feed->bytes()));
  return status;
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
