// What the subcommands share about words on the command line.
#pragma once

#include <string>
#include <vector>

#include "alidade/base/choice.h"

namespace CLI {
class App;
}

namespace alidade {

// Throws Error (usage), with the nearest known name, for the first subcommand or --option that is
// not known. Done before the real parse, whose own complaint might be about something that follows
// from the slip.
void CheckNames(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace alidade
