// A folder that is filled under a temporary name, so that it appears completely or not at all.
#pragma once

#include <string>

namespace alidade {

// Removed by the destructor unless it was renamed. Locked while it exists; one of a killed program
// is unlocked and among StaleTemporaries() of its place.
class DraftFolder {
 public:
  // Named TemporaryBeside(place). Throws Error (input) if it cannot be created.
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
