// Manual pages, for `man`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "describe/command_text.h"

namespace alidade {

struct ManPage {
  std::string file;  // "alidade-run.1"
  std::string text;  // with the macros of man(7)
};

// One page for the program and one for each command: alidade-run.1, alidade-evaluate-ate.1.
// `version`: "alidade 0.2.0".
std::vector<ManPage> ManPages(const CommandText& program, const std::string& version);

}  // namespace alidade
