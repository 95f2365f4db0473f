// Reads and writes whole files.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Upper limits of file sizes, bytes. A longer file is refused before it is read, because it is not
// of the expected kind or was made to exhaust memory.
// Enough for a list of ten million frames, or an image of kMostPixels with 8 bytes each.
inline constexpr size_t kMostFileBytes = size_t{1} << 29;
// Camera files and settings: usually a few hundred.
inline constexpr size_t kMostConfigBytes = size_t{1} << 20;
inline constexpr size_t kStartBytes = 4096;
inline constexpr size_t kMostMapBytes = (size_t{1} << 31) - 1;  // the limit of FlatBuffers

// Reads a whole file. Throws Error (input) when it cannot be read, is longer than `most_bytes`, or
// is a folder, a pipe, a socket or a device (links are followed): reading those may never end.
// Pipes the process was started with, such as a shell's <(command), are read.
std::string ReadFile(const std::string& path, size_t most_bytes = kMostFileBytes);
// The same. `check` is called with the first kStartBytes bytes (or all, if fewer) before memory for
// the rest is allocated; it throws when the file is not of the expected kind.
using StartCheck = std::function<void(std::string_view start)>;
std::string ReadFile(const std::string& path, size_t most_bytes, const StartCheck& check);

// Throws Error (input) when `path` does not exist or is not a file that ReadFile() accepts. For
// callers that pass the path to another library.
void CheckIsFile(const std::string& path);

// Follow links. Also false when the path cannot be examined: no permission, circular links, a name
// that is too long.
bool IsFile(const std::string& path);
bool IsFolder(const std::string& path);
bool IsThere(const std::string& path);  // anything with this name, including a dangling link
// The last part of a path as it was typed, without following links: "walk" for "recordings/walk/".
// For ".", the name of the current folder.
std::string NameAsTyped(const std::string& path);
// Names of the entries of a folder, unsorted. Throws Error (input) when it cannot be read.
std::vector<std::string> NamesIn(const std::string& folder);

enum class Sync {
  kYes,  // flushed to the disk before the rename: survives a power cut
  // Complete or absent, but not flushed. For folders of thousands of small files.
  kNo,
};

// Writes a temporary file beside `path` and renames it, so that `path` holds either all of `bytes`
// or its former content. On failure it throws Error (input) with the reason (disk full, no
// permission, no such folder) and removes the temporary file. Temporary files of killed programs
// are removed by the next write with Sync::kYes to the same path.
void AtomicWriteFile(const std::string& path, std::string_view bytes, Sync sync = Sync::kYes);

// A name next to `path`, unique within this process, for a file or folder that is built there and
// then renamed.
std::string TemporaryBeside(const std::string& path);
// Locks an open file or folder until it is closed or the process ends. Returns false when another
// process holds the lock or the file system has no locks.
bool Occupy(int fd);
// Files and folders beside `path` with names from TemporaryBeside(path) that no process holds
// locked.
std::vector<std::string> StaleTemporaries(const std::string& path);

}  // namespace alidade
