// Whole files in and out.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Where a file ends at the latest, bytes: what is longer is no file of that kind, or was made to
// eat memory, and is refused before it is read.
inline constexpr size_t kMostFileBytes = size_t{1} << 29;    // a list of ten million frames; a
                                                             // picture of kMostPixels, 8 bytes each
inline constexpr size_t kMostConfigBytes = size_t{1} << 20;  // camera and settings: a few hundred
inline constexpr size_t kStartBytes = 4096;
inline constexpr size_t kMostMapBytes = (size_t{1} << 31) - 1;  // FlatBuffers holds no more

// Throws Error (input) when it cannot be read, is longer than `most_bytes`, or is no file but a
// folder, a pipe, a socket or a device (links are followed): those have no end, or none soon. Pipes
// the process was started with are read all the same, as a shell's <(command) has them.
std::string ReadFile(const std::string& path, size_t most_bytes = kMostFileBytes);
// The same, with a look at the first kStartBytes (or all there are) before the rest is read and has
// memory: `check` throws what is to be told of a file that begins otherwise than it should.
using StartCheck = std::function<void(std::string_view start)>;
std::string ReadFile(const std::string& path, size_t most_bytes, const StartCheck& check);

// Throws Error (input) for what ReadFile() would not read because it is no file, or not there: for
// those who hand a path to others.
void CheckIsFile(const std::string& path);

// What is there, links followed. False as well when that cannot be told: no permission on the way,
// links in a circle, a name too long.
bool IsFile(const std::string& path);
bool IsFolder(const std::string& path);
bool IsThere(const std::string& path);  // whatever it is, even a link that leads nowhere
// The last part of a path as it was typed, links left alone: "walk" of "recordings/walk/"; of "."
// what the folder is called.
std::string NameAsTyped(const std::string& path);
// What is in a folder, unsorted. Throws Error (input) when it cannot be read.
std::vector<std::string> NamesIn(const std::string& folder);

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
