// `alidade-bench`: how long the parts take, in milliseconds and in U (docs/benchmarks/index.md).
#include <CLI/CLI.hpp>

#include "alidade/base/error.h"
#include "commands.h"

namespace alidade {

void AddBenchCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("bench", "Moved to the program alidade-bench");
  command->group("");  // hidden
  command->prefix_command();
  command->callback([&action] {
    action = []() -> int {
      ThrowUsage(
          "the benchmarks are now a separate program: `scripts/build alidade-bench` builds "
          "build/bin/alidade-bench");
    };
  });
}

}  // namespace alidade
