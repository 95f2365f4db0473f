// A small file system, to test a full disk.
#pragma once

#include <sys/mount.h>

#include <string>

namespace alidade {

// A mounted file system with a capacity of a few kilobytes.
class SmallDisk {
 public:
  SmallDisk(const std::string& folder, int kilobytes)
      : folder_(folder),
        mounted_(mount("tmpfs", folder.c_str(), "tmpfs", 0,
                       ("size=" + std::to_string(kilobytes) + "k").c_str()) == 0) {}
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  std::string folder_;
  bool mounted_;
};

}  // namespace alidade
