// alidade phone: serves the page for phones, and processes their images with --connected.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/run/play/loop.h"
#include "alidade/serve/viewer_server.h"
#include "commands.h"
#include "phone_host.h"
#include "qr_code.h"
#include "viewer_flags.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

struct PhoneArguments {
  std::optional<std::string> port, host;
  bool tls = false, connected = false;
  std::string core, out;
  std::vector<std::string> set;
};

// Folder of the core: that of the installation or of the source tree; empty: not found.
std::string FindCoreFolder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder : {program / "../share/alidade/core", program / "../../build-wasm"}) {
    if (HasCore(folder.string(), "single")) return fs::weakly_canonical(folder, error).string();
  }
  return {};
}

int Phone(const PhoneArguments& arguments) {
  ServeSettings settings = ServeSettingsFor(arguments.port, arguments.host);
  settings.tls = arguments.tls;
  const std::string core = arguments.core.empty() ? FindCoreFolder() : arguments.core;
  if (!arguments.core.empty() && !HasCore(core, "single"))
    ThrowUsage("--core " + core +
               " contains no single/alidade.wasm (scripts/wasm/build builds it)");
  if (core.empty() && !arguments.connected)
    ThrowUsage(
        "the core for browsers has not been built: run scripts/wasm/build (once, some minutes), or "
        "process the images on this computer with --connected");
  std::unique_ptr<PhoneHost> host;
  if (arguments.connected) {
    PhoneHostSettings serving;
    serving.out = arguments.out;
    for (const std::string& one : arguments.set) {
      const size_t equal = one.find('=');
      if (equal == std::string::npos) ThrowUsage("--set is NAME=VALUE, not '" + one + "'");
      serving.phone.slam.Set(one.substr(0, equal), one.substr(equal + 1));
    }
    host = std::make_unique<PhoneHost>(serving);
  } else if (!arguments.out.empty() || !arguments.set.empty()) {
    ThrowUsage(
        "--out and --set require --connected: otherwise the phone processes the images itself");
  }
  CatchInterrupts();
  const auto server = StartPhonePage(settings, core, host.get());
  const std::string& address = server->address();
  const bool local = address.find("//127.") != std::string::npos ||
                     address.find("//localhost") != std::string::npos ||
                     address.find("//[::1]") != std::string::npos;
  if (!local) std::fputs(QrCode(address).c_str(), stdout);
  std::printf("Page for phones: %s (Ctrl-C ends)\n", address.c_str());
  if (arguments.connected)
    std::printf(
        "Pages may send their images here%s\n",
        core.empty()
            ? "; all of them do, because the core for browsers has not been built "
              "(scripts/wasm/build)"
            : ": in the page choose Settings, Make the map on the computer that serves this page");
  if (!server->fingerprint().empty())
    std::printf(
        "The certificate is self-signed, so the phone's browser asks once whether to "
        "continue.\nIts SHA-256 fingerprint: %s\n",
        server->fingerprint().c_str());
  if (!local && !arguments.tls)
    std::printf("warning: browsers deny the camera to pages without https: add --tls\n");
  std::fflush(stdout);
  while (!Interrupted()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (host) host->EndAbandoned();
  }
  return 0;
}

}  // namespace

void AddPhoneCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("phone", "Serve the page that runs SLAM in a phone's browser");
  auto arguments = std::make_shared<PhoneArguments>();
  AddAddressOptions(*command, arguments->port, arguments->host);
  command->add_flag(
      "--tls", arguments->tls,
      "Use https with a self-signed certificate: browsers allow the camera only on https pages");
  command->add_flag(
      "--connected", arguments->connected,
      "Let pages send their images to this computer, which processes them: for slow phones");
  command
      ->add_option("--core", arguments->core,
                   "Folder of the WebAssembly core that scripts/wasm/build builds; default: that "
                   "of the installation or of the source tree")
      ->type_name("FOLDER");
  command
      ->add_option("--out", arguments->out,
                   "With --connected: folder for the results. The map, trajectory and points of "
                   "each session are written to a new folder in it (session-1, session-2, …) when "
                   "the page has been disconnected for five minutes or the program ends")
      ->type_name("FOLDER");
  command
      ->add_option("--set", arguments->set,
                   "With --connected: change one setting, as for `alidade run`")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->footer(
      "\nExamples:\n  alidade phone                                  on this machine: "
      "http://127.0.0.1:8090/\n  alidade phone --host 0.0.0.0 --tls             for a phone in the "
      "same network: scan the code\n  alidade phone --host 0.0.0.0 --tls --connected --out maps\n  "
      "                                               the same, with processing on this "
      "computer\n\nPrints the address and runs until Ctrl-C (docs/guides/phone.md).");
  command->callback([arguments, &action] { action = [arguments] { return Phone(*arguments); }; });
}

}  // namespace alidade
