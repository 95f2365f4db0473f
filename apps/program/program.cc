#include "program/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/run/run.h"
#include "program/arguments.h"

namespace alidade {
namespace {

constexpr int kBugStatus = 70;  // EX_SOFTWARE

int Complain(const CLI::App& app, std::string message, int status) {
  for (char& c : message) {
    // One line, and nothing in it that a terminal obeys: names and values are quoted as found.
    if ((c >= 0 && c < ' ') || c == '\x7f') c = ' ';
  }
  std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), message.c_str());
  return status;
}

// Where to read on: the innermost subcommand that was named.
std::string HelpOf(const CLI::App& app) {
  std::string path = app.get_name();
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    path += " " + command->get_name();
  }
  return "`" + path + " --help`";
}

int ParseAndRun(CLI::App& app, const Action& action, std::vector<std::string> words) {
  CheckNames(app, words);
  std::reverse(words.begin(), words.end());  // as parse() wants them
  try {
    app.parse(words);
  } catch (const CLI::Success& success) {  // --help and --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return Complain(app, std::string(error.what()) + " (see " + HelpOf(app) + ")",
                    static_cast<int>(ErrorKind::kUsage));
  }
  const int status = action ? action() : 0;
  if (!std::cout.flush() || std::fflush(stdout) != 0) {
    ThrowInput("cannot write to the standard output (is the disk full?)");
  }
  return status;
}

}  // namespace

int RunProgram(int argc, char** argv, const std::function<void(CLI::App&, Action&)>& add,
               const RenewWords& renew) {
  CLI::App app;
  Action action;
  try {
    add(app, action);
    std::vector<std::string> words(argv + 1, argv + argc);
    if (renew) words = renew(app, std::move(words));
    return ParseAndRun(app, action, std::move(words));
  } catch (const Error& error) {
    return Complain(app, error.what(), static_cast<int>(error.kind()));
  } catch (const std::filesystem::filesystem_error& error) {  // a path that cannot be followed
    return Complain(app, error.what(), static_cast<int>(ErrorKind::kInput));
  } catch (const RunStopped& stopped) {
    return Complain(app, stopped.what(), kBugStatus);
  } catch (const std::bad_alloc&) {
    return Complain(app, "out of memory", kBugStatus);
  } catch (const std::exception& error) {
    return Complain(app, std::string("internal error (a bug, please report it): ") + error.what(),
                    kBugStatus);
  } catch (...) {
    return Complain(app, "internal error (a bug, please report it): unknown exception", kBugStatus);
  }
}

}  // namespace alidade
