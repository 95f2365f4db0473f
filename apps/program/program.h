// What the main() of every program does: reads the command line, runs the chosen subcommand, turns
// errors into one line and an exit status.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace alidade {

// What a subcommand does; returns the exit status. Each subcommand sets it when it was chosen.
using Action = std::function<int()>;

// What the words of a command line of an earlier version are now.
using RenewWords =
    std::function<std::vector<std::string>(const CLI::App&, std::vector<std::string>)>;

// `add` names the program and adds its subcommands. Returns the exit status: 0 done, 2 usage,
// 3 input, 70 a bug, else what the action returns.
int RunProgram(int argc, char** argv, const std::function<void(CLI::App&, Action&)>& add,
               const RenewWords& renew = {});

}  // namespace alidade
