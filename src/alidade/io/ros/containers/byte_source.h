// Bytes that are read in pieces: a file that need not fit into memory, or (for tests) a text.
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
  // `count` bytes from `offset`; what lies past the end throws Error (input), before there is
  // memory for it.
  virtual std::string Read(uint64_t offset, uint64_t count) const = 0;
};

// Throws Error (input) when it cannot be opened.
std::unique_ptr<ByteSource> OpenFileSource(const std::string& path);
// `bytes` must outlive it.
std::unique_ptr<ByteSource> SourceOfBytes(std::string_view bytes);

}  // namespace alidade
