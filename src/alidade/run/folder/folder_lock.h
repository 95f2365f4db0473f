// One program at a time in a folder.
#pragma once

#include <string>

namespace alidade {

// Holds a lock (flock) on a file in the folder, which names this process. It ends with this object,
// or with the process in whatever way: then the file stays, and hinders nobody. Where the file
// system has no locks, none is held.
class FolderLock {
 public:
  // `file`: made where it is not there, with the folder it is in. Throws Error (input) when another
  // process holds it, beginning with `where` and naming the process.
  FolderLock(const std::string& file, const std::string& where);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::string file_;
  int fd_ = -1;
};

}  // namespace alidade
