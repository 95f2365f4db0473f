// Loads optional parts of the program from shared libraries at run time. Linking them would slow
// down every start (OpenCV's media libraries: 77 MB and 0.1 s), and most runs do not need them
// (OpenCV's networks).
#pragma once

#include <string>
#include <utility>
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

// The only function of a module; null: see `problem`.
template <typename Function>
struct LoadedFunction {
  Function* call = nullptr;
  std::string problem;
};

template <typename Function>
LoadedFunction<Function> LoadFunction(const std::string& file, const std::string& name) {
  LoadedModule loaded = LoadModule(file, {name});
  if (loaded.symbols.empty()) return {nullptr, std::move(loaded.problem)};
  return {reinterpret_cast<Function*>(loaded.symbols[0]), {}};
}

}  // namespace alidade
