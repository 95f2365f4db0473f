#include "alidade/run/folder/draft_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {

DraftFolder::DraftFolder(const std::string& place) : path_(TemporaryBeside(place)) {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error) ThrowInput(place + ": cannot be created: " + error.message());
  fd_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd_ >= 0) Occupy(fd_);
}

DraftFolder::~DraftFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace alidade
