// Random access to bytes: a file that need not fit into memory, or a string (for tests).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace alidade {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t Size() const = 0;
  // Reads `count` bytes from `offset`. Throws Error (input), before allocating, when the range
  // exceeds the source.
  virtual std::string Read(uint64_t offset, uint64_t count) const = 0;
};

// Throws Error (input) when the file cannot be opened.
std::unique_ptr<ByteSource> OpenFileSource(const std::string& path);
// `bytes` must outlive the source.
std::unique_ptr<ByteSource> SourceOfBytes(std::string_view bytes);

}  // namespace alidade
