// build-fuzz/bin/fuzz --target=NAME, with libFuzzer's options and folders (libFuzzer ignores
// options with two dashes).
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <opencv2/core.hpp>

#include "fuzz/targets.h"

namespace {

const alidade::fuzz::Target* target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr char kOption[] = "--target=";
  std::string name;
  for (int i = 1; i < *argc; ++i) {
    if (std::strncmp((*argv)[i], kOption, std::strlen(kOption)) == 0)
      name = (*argv)[i] + std::strlen(kOption);
  }
  for (const alidade::fuzz::Target& known : alidade::fuzz::Targets()) {
    if (known.name == name) target = &known;
  }
  cv::setNumThreads(1);
  if (target != nullptr) return 0;
  std::cerr << "fuzz: --target=NAME is one of:";
  for (const alidade::fuzz::Target& known : alidade::fuzz::Targets())
    std::cerr << " " << known.name;
  std::cerr << "\n";
  std::exit(2);
}

// Any exception other than Error ends the program and is a finding.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  alidade::fuzz::Accepts(*target, {reinterpret_cast<const char*>(data), size});
  return 0;
}
