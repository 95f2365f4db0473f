// main() of all programs: parses the command line, runs the chosen subcommand, and reports errors
// as one line and an exit status.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace alidade {

// Runs a subcommand and returns the exit status. Set by the chosen subcommand.
using Action = std::function<int()>;

// Translates the words of a command line of an earlier version.
using RenewWords =
    std::function<std::vector<std::string>(const CLI::App&, std::vector<std::string>)>;

// `add` sets the program's name and adds its subcommands. Returns the exit status: 0 done, 2 usage,
// 3 input, 70 a bug, else the result of the action.
int RunProgram(int argc, char** argv, const std::function<void(CLI::App&, Action&)>& add,
               const RenewWords& renew = {});

}  // namespace alidade
