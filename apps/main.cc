// The alidade program: reads the command line, runs one subcommand, turns errors into one line and
// a status.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/run/run.h"
#include "alidade/version.h"
#include "arguments.h"
#include "commands.h"

namespace {

constexpr int kBugStatus = 70;  // EX_SOFTWARE

int Complain(std::string message, int status) {
  for (char& c : message) {
    // One line, and nothing in it that a terminal obeys: names and values are quoted as found.
    if ((c >= 0 && c < ' ') || c == '\x7f') c = ' ';
  }
  std::fprintf(stderr, "alidade: %s\n", message.c_str());
  return status;
}

void AddCommands(CLI::App& app, alidade::Action& action) {
  alidade::AddRunCommand(app, action);
  alidade::AddLocalizeCommand(app, action);
  alidade::AddEvaluateCommand(app, action);
  alidade::AddSynthCommand(app, action);
  alidade::AddExportCommand(app, action);
  alidade::AddViewCommand(app, action);
  alidade::AddPhoneCommand(app, action);
  alidade::AddCompareCommand(app, action);
  alidade::AddMergeCommand(app, action);
  alidade::AddBatchCommand(app, action);
  alidade::AddInfoCommand(app, action);
  alidade::AddCalibrateCommand(app, action);
  alidade::AddBenchCommand(app, action);
  alidade::AddDescribeCommands(app, action);
}

// Where to read on: the innermost subcommand that was named.
std::string HelpOf(const CLI::App& app) {
  std::string path = "alidade";
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    path += " " + command->get_name();
  }
  return "`" + path + " --help`";
}

int Run(int argc, char** argv) {
  CLI::App app(
      "Alidade: from what a moving camera sees to where it is and what the place looks like.",
      "alidade");
  app.set_version_flag("--version", "alidade " ALIDADE_VERSION);
  app.set_help_flag("-h,--help", "Show this help; each command has its own");
  app.require_subcommand(1);
  app.footer(
      "\nExamples:\n"
      "  alidade run my_recording                    a TUM, EuRoC or KITTI folder, images or a "
      "video\n"
      "  alidade run \"synth:room?frames=300\"         a rendered room, no recording needed\n"
      "  alidade evaluate ate truth.txt alidade-out/my_recording/trajectory.txt\n"
      "  alidade run my_recording --viewer           watch it in a browser\n"
      "  alidade phone --host 0.0.0.0 --tls          the page for phones, for one in this network\n"
      "  alidade compare result_a result_b           two runs beside each other\n"
      "  alidade info alidade-out/my_recording       what is in a map\n"
      "  alidade run --help                          all of a command's options\n"
      "\nExit status: 0 done, 2 usage, 3 input, 4 nothing could be mapped, 70 a bug of ours, 130 "
      "interrupted.");
  alidade::Action action;
  AddCommands(app, action);
  alidade::CheckNames(app, std::vector<std::string>(argv + 1, argv + argc));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help and --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return Complain(std::string(error.what()) + " (see " + HelpOf(app) + ")",
                    static_cast<int>(alidade::ErrorKind::kUsage));
  }
  const int status = action ? action() : 0;
  if (!std::cout.flush() || std::fflush(stdout) != 0) {
    alidade::ThrowInput("cannot write to the standard output (is the disk full?)");
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const alidade::Error& error) {
    return Complain(error.what(), static_cast<int>(error.kind()));
  } catch (const std::filesystem::filesystem_error& error) {  // a path that cannot be followed
    return Complain(error.what(), static_cast<int>(alidade::ErrorKind::kInput));
  } catch (const alidade::RunStopped& stopped) {
    return Complain(stopped.what(), kBugStatus);
  } catch (const std::bad_alloc&) {
    return Complain("out of memory", kBugStatus);
  } catch (const std::exception& error) {
    return Complain(std::string("a bug of ours, please report it: ") + error.what(), kBugStatus);
  } catch (...) {
    return Complain("a bug of ours, please report it: unknown exception", kBugStatus);
  }
}
