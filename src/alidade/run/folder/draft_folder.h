// A folder that is built beside its place, so that it is there whole or not at all.
#pragma once

#include <string>

namespace alidade {

// Gone at the end unless it was renamed. While it lives, other programs know that it is in use; one
// left by a program that was killed is among StaleTemporaries() of its place.
class DraftFolder {
 public:
  // Named TemporaryBeside(place). Throws Error (input) when it cannot be made.
  explicit DraftFolder(const std::string& place);
  ~DraftFolder();
  DraftFolder(const DraftFolder&) = delete;
  DraftFolder& operator=(const DraftFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int fd_ = -1;
};

}  // namespace alidade
