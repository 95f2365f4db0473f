// docs/reference/cli.md: every command and option, from the command line itself.
#pragma once

#include <string>

#include "describe/command_text.h"

namespace alidade {

// One page in Markdown: the program, then a section for each command.
std::string MarkdownPage(const CommandText& program);

}  // namespace alidade
