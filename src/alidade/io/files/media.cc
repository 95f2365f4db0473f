#include "alidade/io/files/media.h"

#include <dlfcn.h>

#include <filesystem>
#include <vector>

#include "alidade/base/error.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

struct Module {
  MediaDecodeFunction* decode = nullptr;
  MediaOpenFunction* open = nullptr;
  std::string problem;
};

// Beside what holds this code (the program, or a library such as the Python module), in ../lib of
// it, and where the system keeps libraries.
std::vector<std::string> PlacesToLook() {
  std::vector<std::string> places;
  const auto add = [&places](const fs::path& binary) {
    const fs::path folder = binary.parent_path();
    places.push_back((folder / kMediaModuleFile).string());
    places.push_back((folder / "../lib" / kMediaModuleFile).string());
  };
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) add(program);
  Dl_info here{};
  if (dladdr(reinterpret_cast<void*>(&OpenVideo), &here) != 0 && here.dli_fname != nullptr) {
    add(fs::absolute(here.dli_fname, error));
  }
  places.push_back(kMediaModuleFile);
  return places;
}

Module LoadModule() {
  Module module;
  for (const std::string& place : PlacesToLook()) {
    std::error_code error;
    if (place.find('/') != std::string::npos && !fs::exists(place, error)) continue;
    void* handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
      module.problem = dlerror();
      continue;
    }
    module.decode = reinterpret_cast<MediaDecodeFunction*>(dlsym(handle, "alidade_media_decode"));
    module.open = reinterpret_cast<MediaOpenFunction*>(dlsym(handle, "alidade_media_open"));
    if (module.decode != nullptr && module.open != nullptr) {
      module.problem.clear();
      return module;
    }
    module.problem = place + " is not of this version";
  }
  return module;
}

const Module& TheModule() {
  static const Module module = LoadModule();  // never unloaded
  return module;
}

std::unique_ptr<MediaStream> Open(const std::string& path, int camera, const std::string& name,
                                  const std::string& advice) {
  const Module& module = TheModule();
  if (module.open == nullptr)
    ThrowInput(name + " needs " + kMediaModuleFile + ": " + module.problem);
  std::unique_ptr<MediaStream> stream(module.open(path.c_str(), camera));
  if (!stream) ThrowInput(name + " cannot be opened: " + advice);
  return stream;
}

}  // namespace

DecodedImage DecodeByMediaModule(std::string_view bytes, ImageUse use) {
  const Module& module = TheModule();
  if (module.decode == nullptr) {
    return {{},
            std::string("is no JPEG or PNG, and other images need ") + kMediaModuleFile + ": " +
                module.problem};
  }
  DecodedImage decoded;
  if (!module.decode(bytes.data(), bytes.size(), static_cast<int>(use), &decoded.image)) {
    return {{}, "is no image, or a damaged one"};
  }
  if (use == ImageUse::kDepth && decoded.image.type() == CV_8UC1)
    decoded.image.convertTo(decoded.image, CV_16U);
  if (use == ImageUse::kDepth && decoded.image.type() != CV_16UC1 &&
      decoded.image.type() != CV_32FC1) {
    return {{}, "is a colour image: depth has one channel"};
  }
  return decoded;
}

std::unique_ptr<MediaStream> OpenVideo(const std::string& path) {
  return Open(path, 0, path, "it is no video or image folder that is known");
}

std::unique_ptr<MediaStream> OpenLiveCamera(int number) {
  return Open("", number, "camera:" + std::to_string(number), "is it connected, and not in use?");
}

}  // namespace alidade
