// Loads a part of the program that lives in a shared library of its own, because linking what it
// stands on would cost every start (77 MB and 0.1 s for OpenCV's media), or because most runs do
// without it (its networks).
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct LoadedModule {
  std::vector<void*> symbols;  // one for each name asked for; empty when there is a problem
  std::string problem;         // why there is none, one line
};

// Looks beside what holds this code (the program, or a library such as a Python module), in the
// folder of modules below the library folder next to it, where the system keeps libraries, and
// where this version was meant to be installed. Never unloaded: call it once.
LoadedModule LoadModule(const std::string& file, const std::vector<std::string>& names);

}  // namespace alidade
