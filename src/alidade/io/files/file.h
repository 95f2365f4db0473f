// Whole files in and out.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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
// temporary; one left by a program that was killed meanwhile is removed by the next write with
// Sync::kYes.
void AtomicWriteFile(const std::string& path, std::string_view bytes, Sync sync = Sync::kYes);

// For what else is built beside its place and renamed: a name next to `path`, which this process
// gives only once.
std::string TemporaryBeside(const std::string& path);
// Marks an open file or folder as in use until it is closed, or its program ends in whatever way.
// False when another has it, or the file system knows no locks.
bool Occupy(int fd);
// Files and folders with names of TemporaryBeside(path) which nobody uses any more.
std::vector<std::string> StaleTemporaries(const std::string& path);

}  // namespace alidade
