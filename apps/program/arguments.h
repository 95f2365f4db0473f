// Checks command lines for typing errors.
#pragma once

#include <string>
#include <vector>

#include "alidade/base/choice.h"

namespace CLI {
class App;
}

namespace alidade {

// Throws Error (usage), suggesting the nearest known name, for the first unknown subcommand or
// --option. Called before the real parser, whose message might be about a later consequence of the
// typing error.
void CheckNames(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace alidade
