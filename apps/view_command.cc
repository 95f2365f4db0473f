// alidade view: shows a recorded run or a map in a browser.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/run/export/mcap_export.h"
#include "alidade/run/export/result_stream.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/recorder/record_file.h"
#include "alidade/run/recorder/stream_file.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/serve/viewer_server.h"
#include "alidade/stream/stream_hub.h"
#include "commands.h"
#include "viewer_flags.h"

namespace alidade {
namespace {

struct ViewArguments {
  std::string what;
  std::optional<std::string> port, host;
};

// A hub without further messages.
class StillHub : public StreamHub {
 public:
  explicit StillHub(std::vector<std::string> messages) {
    for (std::string& message : messages)
      messages_.push_back(std::make_shared<const std::string>(std::move(message)));
  }
  int Join(Take take) override {
    for (const auto& message : messages_) take(message);
    return 0;
  }
  void Leave(int) override {}
  void Control(StreamControl) override {}

 private:
  std::vector<std::shared_ptr<const std::string>> messages_;
};

int View(const ViewArguments& arguments) {
  if (IsMcap(arguments.what))
    ThrowInput(arguments.what +
               ": MCAP files are for Foxglove, Lichtblick, Rerun and ros2 (docs/guides/mcap.md); "
               "`alidade view` shows result folders, run.stream and maps");
  const std::string recorded = StreamIn(arguments.what);
  std::unique_ptr<StillHub> hub;
  StillMap still;
  if (recorded.empty()) {
    ResultStream result = StreamOfResult(ReadSavedMap(arguments.what), arguments.what);
    hub = std::make_unique<StillHub>(std::move(result.messages));
    const Eigen::Quaterniond q = result.T_map_files.Quaternion();
    const Eigen::Vector3d& t = result.T_map_files.t;
    still = {result.cloud, result.mesh, {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()}};
  } else {
    StreamFileReader check(recorded);  // reports a damaged file before a page connects
  }
  CatchInterrupts();
  const auto server = StartViewer(ServeSettingsFor(arguments.port, arguments.host), hub.get(),
                                  recorded, arguments.what, hub ? &still : nullptr);
  std::printf("Viewer of %s: %s (Ctrl-C ends)\n", arguments.what.c_str(),
              server->address().c_str());
  std::fflush(stdout);
  while (!Interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace

void AddViewCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("view", "Show a run or a map in a browser");
  auto arguments = std::make_shared<ViewArguments>();
  command
      ->add_option("WHAT", arguments->what,
                   "Result folder, recorded stream (run.stream) or map (map.alidade)")
      ->required()
      ->type_name("PATH");
  AddAddressOptions(*command, arguments->port, arguments->host);
  command->footer(
      "\nExamples:\n  alidade run kitchen --record && alidade view alidade-out/kitchen     replays "
      "the run\n  alidade view alidade-out/kitchen                                     without "
      "--record: map, path and depth\n  alidade view alidade-out/kitchen --host 0.0.0.0            "
      "          for another "
      "device\n\nPrints the address and runs until Ctrl-C.");
  command->callback([arguments, &action] { action = [arguments] { return View(*arguments); }; });
}

}  // namespace alidade
