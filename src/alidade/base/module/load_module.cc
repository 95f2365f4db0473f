#include "alidade/base/module/load_module.h"

#include <dlfcn.h>

#include <filesystem>

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> PlacesToLook(const std::string& file) {
  std::vector<std::string> places;
  const auto add = [&](const fs::path& binary) {
    const fs::path folder = binary.parent_path();
    places.push_back((folder / file).string());  // beside the loading binary, e.g. a Python wheel
    places.push_back((folder / "../lib" / file).string());         // build folder
    places.push_back((folder / ALIDADE_MODULES / file).string());  // installed shared library
    places.push_back(
        (folder / ".." / ALIDADE_LIBDIR / ALIDADE_MODULES / file).string());  // installed program
  };
  std::error_code error;
  // The binary that contains this code comes first: the folder of the Python interpreter may
  // contain modules of another version.
  Dl_info here{};
  if (dladdr(reinterpret_cast<void*>(&LoadModule), &here) != 0 && here.dli_fname != nullptr) {
    add(fs::absolute(here.dli_fname, error));
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) add(program);
  places.push_back(file);  // the loader's search path, for programs that link the static library
  places.push_back(std::string(ALIDADE_INSTALLED) + "/" + file);
  return places;
}

}  // namespace

LoadedModule LoadModule(const std::string& file, const std::vector<std::string>& names) {
  std::string problem;
  bool exists = false;
  for (const std::string& place : PlacesToLook(file)) {
    std::error_code error;
    if (place.find('/') != std::string::npos) {
      if (!fs::exists(place, error)) continue;
      exists = true;
    }
    void* handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
      // Keep the first error: the last place is the system path, where "file not found" says
      // little.
      if (problem.empty()) problem = dlerror();
      continue;
    }
    LoadedModule module;
    for (const std::string& name : names) {
      if (void* symbol = dlsym(handle, name.c_str())) module.symbols.push_back(symbol);
    }
    if (module.symbols.size() == names.size()) return module;
    dlclose(handle);
    problem = place + " belongs to another version";
  }
  if (!exists) problem = "it has not been built (scripts/setup installs the packages it needs)";
  return {{}, problem};
}

}  // namespace alidade
