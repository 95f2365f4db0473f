// Lets one program at a time write to a folder.
#pragma once

#include <string>

namespace alidade {

// Holds a lock (flock) on a file in the folder that names this process, until this object is
// destroyed or the process ends. The file may remain; it does not block later runs. Without effect
// on file systems without locks.
class FolderLock {
 public:
  // `file`: created with its folder if it does not exist. Throws Error (input), beginning with
  // `where`, if another process holds the lock; the message names the process.
  FolderLock(const std::string& file, const std::string& where);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::string file_;
  int fd_ = -1;
};

}  // namespace alidade
