// An open device of the system.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

namespace alidade {

class DeviceFile {
 public:
  DeviceFile() = default;
  explicit DeviceFile(const std::string& path);  // check valid()
  ~DeviceFile();
  DeviceFile(DeviceFile&& other) noexcept
      : file_(std::exchange(other.file_, -1)), error_(other.error_) {}
  DeviceFile& operator=(DeviceFile&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(error_, other.error_);
    return *this;
  }
  bool valid() const { return file_ >= 0; }
  int error() const { return error_; }  // errno of the failed opening

  // ioctl(); repeats interrupted calls. Returns 0 or the errno.
  int Ask(unsigned long request, void* argument) const;
  // Waits until there is something to read. Returns 1, 0 after `seconds`, or -errno.
  int Wait(double seconds) const;

 private:
  friend class MappedBuffer;
  int file_ = -1, error_ = 0;
};

// Memory of a driver.
class MappedBuffer {
 public:
  MappedBuffer(const DeviceFile& file, size_t size, size_t offset);  // check data()
  ~MappedBuffer();
  MappedBuffer(MappedBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(other.size_) {}
  MappedBuffer& operator=(MappedBuffer&&) = delete;
  const char* data() const { return data_; }
  size_t size() const { return size_; }

 private:
  char* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace alidade
