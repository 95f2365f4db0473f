// Generates shell scripts that complete commands, options and values.
#pragma once

#include <string>

#include "describe/command_text.h"

namespace alidade {

// Each returns a complete file.
std::string BashCompletion(const CommandText& program);
std::string ZshCompletion(const CommandText& program);
std::string FishCompletion(const CommandText& program);

// The first clause of a help text, without full stop, for lists with one line per option.
std::string ShortHelp(const std::string& help);

}  // namespace alidade
