// alidade serve: answers pictures over HTTP with their poses in a map.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "alidade/run/play/loop.h"
#include "alidade/run/service/localize_host.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/serve/viewer_server.h"
#include "commands.h"
#include "viewer_flags.h"

namespace alidade {
namespace {

struct ServeArguments {
  std::string map;
  std::optional<std::string> port, host;
  bool tls = false;
  int threads = 0;
};

int Serve(const ServeArguments& arguments) {
  ServeSettings settings = ServeSettingsFor(arguments.port, arguments.host);
  settings.tls = arguments.tls;
  LocalizeHostSettings serving;
  serving.threads = arguments.threads;
  LocalizeHost host(ReadSavedMap(arguments.map), arguments.map, serving);
  CatchInterrupts();
  const auto server = StartPostPage(settings, host.Info(), &host);
  const SavedMap& saved = host.localizer().saved();
  std::printf("Poses in %s (%d keyframes): %s (Ctrl-C ends)\n", arguments.map.c_str(),
              saved.map.keyframe_count(), server->address().c_str());
  std::string address = server->address();
  const size_t mark = address.find('?');
  address.insert(std::min(mark, address.size()), "localize");
  std::printf("  curl --data-binary @photo.jpg '%s%sfov=66'\n", address.c_str(),
              mark == std::string::npos ? "?" : "&");
  if (!server->fingerprint().empty())
    std::printf("The certificate is self-signed (curl --insecure). Its SHA-256 fingerprint: %s\n",
                server->fingerprint().c_str());
  std::fflush(stdout);
  while (!Interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace

void AddServeCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("serve", "Answer pictures over HTTP with their poses in a map");
  auto arguments = std::make_shared<ServeArguments>();
  command->add_option("MAP", arguments->map, "Map (map.alidade), or result folder with one")
      ->required()
      ->type_name("PATH");
  AddAddressOptions(*command, arguments->port, arguments->host);
  command->add_flag("--tls", arguments->tls, "Use https with a self-signed certificate");
  command
      ->add_option("--threads", arguments->threads,
                   "Pictures processed at a time; 0: one per core. Default: 0")
      ->type_name("N")
      ->check(CLI::Range(0, 256));
  command->footer(
      "\nExamples:\n"
      "  alidade serve alidade-out/kitchen\n"
      "  curl --data-binary @photo.jpg 'http://127.0.0.1:8090/localize'           lens by EXIF\n"
      "  curl --data-binary @photo.jpg 'http://127.0.0.1:8090/localize?fov=66'    degrees\n"
      "  curl --data-binary @photo.png 'http://127.0.0.1:8090/localize?fx=525&fy=525&cx=319.5&"
      "cy=239.5'\n"
      "  curl --data-binary @photo.png 'http://127.0.0.1:8090/localize?camera=map'\n"
      "\nThe picture may come from another camera than the map: a phone in the map of a depth "
      "camera.\nThe answer is JSON: {\"placed\": true, \"position\": [x, y, z], \"quaternion\": "
      "[x, y, z, w],\n\"covariance\": 6x6, \"probability\": …} or {\"placed\": false, \"why\": "
      "…}. The page at / has a form\nto try it. Runs until Ctrl-C (docs/guides/localize.md).");
  command->callback([arguments, &action] { action = [arguments] { return Serve(*arguments); }; });
}

}  // namespace alidade
