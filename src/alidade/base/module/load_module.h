// Loads optional parts of the program from shared libraries at run time. Linking them would slow
// down every start (OpenCV's media libraries: 77 MB and 0.1 s), and most runs do not need them
// (OpenCV's networks).
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct LoadedModule {
  std::vector<void*> symbols;  // one per requested name; empty on failure
  std::string problem;         // one line that says why loading failed
};

// Searches, in this order: the folder of the binary that contains this code (the program, or a
// library such as a Python module), the module folder below the neighboring library folder, the
// system's library path, and the installation folder of this version. The module is never unloaded,
// so call this once per module. Does not throw: failures are in `problem`.
LoadedModule LoadModule(const std::string& file, const std::vector<std::string>& names);

}  // namespace alidade
