// alidade run, localize: a recording or camera in, a trajectory and a map out.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "alidade/run/play/loop.h"
#include "alidade/run/recorder/stream_feed.h"
#include "alidade/run/run.h"
#include "alidade/serve/viewer_server.h"
#include "alidade/version.h"
#include "commands.h"
#include "run/pose_teller.h"
#include "run/run_and_tell.h"
#include "run/run_flags.h"
#include "run/run_progress.h"
#include "viewer_flags.h"

namespace alidade {
namespace {

constexpr int kShortPath = 100;  // frames: the least that the setting may be

}  // namespace

int RunAndTell(const RunOptions& options, const MakeWatcher& make_watcher) {
  CatchInterrupts();
  std::optional<PoseTeller> poses;
  if (options.poses) poses.emplace(*options.poses);  // first: no message may come between poses
  RunProgress progress(options.quiet);
  std::vector<RunWatcher*> watchers = {&progress};
  if (poses) watchers.push_back(&*poses);
  std::optional<StreamFeed> feed;
  std::unique_ptr<RunWatcher> watcher;
  std::unique_ptr<ViewerServer> server;
  const std::optional<std::string> record = RecordFileOf(options);
  if (record || options.viewer || make_watcher) {
    CheckRunOptions(options);
    const StreamFeedSettings stream = SettingsFrom(options).stream;
    StreamFeedSettings fed = stream;
    if (!record && !options.viewer) {
      // Nobody looks at the images, and nobody joins later, who would get the path.
      fed.pictures_hz = 0;
      fed.stream.path_frames = std::min(fed.stream.path_frames, kShortPath);
    }
    feed.emplace("alidade " ALIDADE_VERSION, record, fed);
    if (make_watcher) {
      watcher = make_watcher(*feed, stream);
      watchers.push_back(&*watcher);
    }
    watchers.push_back(&*feed);
  }
  if (options.viewer) {
    server = StartViewer(ServeSettingsFor(options.port, options.host), &*feed, "", options.source);
    std::printf("Viewer: %s\n", server->address().c_str());
    std::fflush(stdout);
  }
  const int status = Run(options, watchers).status;
  if (record && !options.quiet && feed->frames() > 0)
    std::printf("The recorded stream has %.1f MB\n", 1e-6 * static_cast<double>(feed->bytes()));
  if (server && isatty(STDOUT_FILENO) != 0) {
    std::printf("Viewer still at %s; Ctrl-C ends\n", server->address().c_str());
    std::fflush(stdout);
    while (!Interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return status;
}

void AddRunCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "run", "Estimate the trajectory of a recording, video or live camera, and a map");
  auto options = std::make_shared<RunOptions>();
  AddRunOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return RunAndTell(*options); }; });
}

void AddLocalizeCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("localize", "Estimate the poses of a recording in a saved map");
  auto options = std::make_shared<RunOptions>();
  AddLocalizeOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return RunAndTell(*options); }; });
}

}  // namespace alidade
