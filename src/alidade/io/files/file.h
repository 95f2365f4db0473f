// Whole files in and out.
#pragma once

#include <string>
#include <string_view>

namespace alidade {

// Throws Error (input) when it cannot be read.
std::string ReadFile(const std::string& path);

enum class Sync {
  kYes,  // on the disk before it gets its name: survives a power cut
  kNo,   // for the thousands of small files of a folder: never half written, but not flushed one by
         // one
};

// Writes a temporary beside `path` and renames it: `path` holds all of `bytes` or what it held
// before. Throws Error (input) saying why (disk full, no permission, no such folder), leaving no
// temporary.
void AtomicWriteFile(const std::string& path, std::string_view bytes, Sync sync = Sync::kYes);

}  // namespace alidade
