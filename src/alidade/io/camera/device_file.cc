#include "alidade/io/camera/device_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>

namespace alidade {

DeviceFile::DeviceFile(const std::string& path) {
  file_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) error_ = errno;
}

DeviceFile::~DeviceFile() {
  if (file_ >= 0) ::close(file_);
}

int DeviceFile::Ask(unsigned long request, void* argument) const {
  while (::ioctl(file_, request, argument) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

int DeviceFile::Wait(double seconds) const {
  pollfd wanted{file_, POLLIN, 0};
  const int ready = ::poll(&wanted, 1, static_cast<int>(std::lround(1000 * seconds)));
  if (ready < 0) return errno == EINTR ? 0 : -errno;
  if (ready > 0 && (wanted.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return -ENODEV;
  return ready;
}

MappedBuffer::MappedBuffer(const DeviceFile& file, size_t size, size_t offset) : size_(size) {
  void* at = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file.file_,
                    static_cast<off_t>(offset));
  if (at != MAP_FAILED) data_ = static_cast<char*>(at);
}

MappedBuffer::~MappedBuffer() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

}  // namespace alidade
