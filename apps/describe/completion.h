// Scripts that make a shell complete the program's commands, options and their values.
#pragma once

#include <string>

#include "describe/command_text.h"

namespace alidade {

// Each is a whole file, as the shell wants it.
std::string BashCompletion(const CommandText& program);
std::string ZshCompletion(const CommandText& program);
std::string FishCompletion(const CommandText& program);

// The first sentence of a help text, without a full stop: there is one line for it.
std::string ShortHelp(const std::string& help);

}  // namespace alidade
